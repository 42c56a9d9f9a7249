#include "voxshell/batch.h"

#include "voxshell/parallel.h"

namespace voxshell {
namespace {

/// Poses that one thread takes at a time: enough to share a scratch, few enough to share the work.
constexpr std::size_t kPosesPerTask = 64;

Error stopped() { return {ErrorCode::kCanceled, "the batch of queries was stopped"}; }

}  // namespace

Result<ContactBatch> find_contacts_batch(const Field& field, const PointShell& shell,
                                         std::span<const Pose> field_from_shell,
                                         const ContactOptions& options, unsigned threads,
                                         const Progress& progress) {
  const std::size_t count = field_from_shell.size();
  std::vector<std::vector<Contact>> found(count / kPosesPerTask + 1);
  ContactBatch batch;
  batch.offsets.assign(count + 1, 0);
  const auto ask = [&](std::size_t begin, std::size_t end) {
    QueryScratch scratch;
    std::vector<Contact>& of_task = found[begin / kPosesPerTask];
    for (std::size_t i = begin; i < end; ++i) {
      const auto contacts = find_contacts(field, shell, field_from_shell[i], options, scratch);
      of_task.insert(of_task.end(), contacts.begin(), contacts.end());
      batch.offsets[i + 1] = contacts.size();
    }
  };
  if (!parallel_for_ranges(count, kPosesPerTask, threads, "contacts", progress, ask)) {
    return stopped();
  }
  for (std::size_t i = 1; i < batch.offsets.size(); ++i) batch.offsets[i] += batch.offsets[i - 1];
  batch.contacts.reserve(batch.offsets.back());
  for (std::vector<Contact>& of_task : found) {
    batch.contacts.insert(batch.contacts.end(), of_task.begin(), of_task.end());
    of_task = {};
  }
  return batch;
}

Result<std::vector<char>> collides_batch(const Field& field, const PointShell& shell,
                                         std::span<const Pose> field_from_shell, float margin,
                                         unsigned threads, const Progress& progress) {
  std::vector<char> result(field_from_shell.size());
  const auto ask = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      result[i] = collides(field, shell, field_from_shell[i], margin) ? 1 : 0;
    }
  };
  if (!parallel_for_ranges(result.size(), kPosesPerTask, threads, "collisions", progress, ask)) {
    return stopped();
  }
  return result;
}

}  // namespace voxshell

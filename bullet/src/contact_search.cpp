#include "contact_search.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "arrivals.h"
#include "conservative_advancement.h"
#include "contact_constants.h"
#include "contact_list.h"
#include "contact_rule.h"
#include "core_segment.h"
#include "edge_crossings.h"
#include "facing_normals.h"
#include "foremost.h"
#include "impact.h"
#include "of_this_thread.h"
#include "voxshell/manifold.h"
#include "walls_ahead.h"
#include "way_out.h"

namespace voxshell::bullet {
namespace {

/// The contact of models of which one lies wholly inside the other, or in its very place.
std::optional<Contact> find_enclosed(const PosedPair& pair) {
  const Pose field_from_shell = pair.field_from_shell();
  auto found =
      find_inner_contact(pair.shell_side().participant(), pair.field(), field_from_shell, 0.0f);
  if (!found && pair.field_side().model() != nullptr) {
    const Pose shell_from_field = field_from_shell.inverse();
    found = find_inner_contact(pair.field_side().participant(), pair.second_field(),
                               shell_from_field, 0.0f);
    if (found) found = turn_over(*found, shell_from_field);
  }
  return found;
}

/// Of the two bodies, world frame. What is pushed there is displaced and does not turn; of two that
/// are as heavy, the smaller one.
Vec3 middle_of_lighter(const PairStep& step) {
  const double of_a = step.motion_a.inverse_mass;
  const double of_b = step.motion_b.inverse_mass;
  if (of_a != of_b) return of_a > of_b ? step.motion_a.center : step.motion_b.center;
  const PosedPair& pair = *step.pair;
  const Side& smaller = step.larger == &pair.shell_side() ? pair.field_side() : pair.shell_side();
  return smaller.bounding_ball().center;
}

/// The lists that no thread uses now. They outlast threads, which come and go with each step.
class FreeLists {
 public:
  std::unique_ptr<QueryLists> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) {
      // All may come back at once.
      free_.reserve(made_ + 1);
      auto lists = std::make_unique<QueryLists>();
      ++made_;
      return lists;
    }
    std::unique_ptr<QueryLists> lists = std::move(free_.back());
    free_.pop_back();
    return lists;
  }
  void give_back(std::unique_ptr<QueryLists> lists) noexcept {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(lists));
  }
  /// Lives as long as the process: threads may end after its other objects.
  static FreeLists& all() {
    static auto* const lists = new FreeLists;
    return *lists;
  }

 private:
  std::mutex mutex_;
  std::size_t made_ = 0;
  std::vector<std::unique_ptr<QueryLists>> free_;
};

/// One for all pairs, as a thread asks about one pair at a time.
QueryLists& lists_of_this_thread() {
  struct Borrowed {
    std::unique_ptr<QueryLists> lists = FreeLists::all().take();
    Borrowed() = default;
    Borrowed(const Borrowed&) = delete;
    Borrowed& operator=(const Borrowed&) = delete;
    ~Borrowed() { FreeLists::all().give_back(std::move(lists)); }
  };
  return *of_this_thread<Borrowed>().lists;
}

}  // namespace

void ContactSearch::OfShell::gather_exact(std::vector<std::uint32_t>& exact) const {
  exact.clear();
  round.append_ids(0, exact);
  on_round.append_ids(0, exact);
  std::ranges::sort(exact);
}

int level_of(const ContactSettings& settings, bool uses_ccd) {
  if (settings.level > 0) return std::min(settings.level, PointSphereTree::kMaxLevel);
  // What kSegmented promises does not change from step to step.
  const bool finer = uses_ccd && settings.mode != ContactMode::kSegmented;
  return finer ? kDefaultCcdLevel : kDefaultLevel;
}

/// What is looked for.
struct ContactSearch::Question {
  const ContactSettings& settings;
  const PairStep* step;  ///< null in contact tests
  Wanted wanted;
  int level;
  float reach;  ///< of surfaces thickened by Bullet's margins, contacts are points that near
  TouchScale touch;
  bool slides;  ///< to the deepest places of smooth surfaces

  Question(const ContactSettings& of, const PosedPair& pair, double margin, const PairStep* at,
           Wanted what)
      : settings(of),
        step(at),
        wanted(what),
        level(level_of(of, at != nullptr && at->uses_ccd)),
        reach(static_cast<float>(margin + pair.thickness())),
        touch(at == nullptr ? TouchScale{}
                            : TouchScale{at->ball.radius, at->rest_margin, at->thickness}),
        // What kSegmented promises are points, and so are contacts without a margin.
        slides(at != nullptr && touch.margin > 0.0 && of.mode != ContactMode::kSegmented) {}

  /// How near its samples are, where the model's own surface is within reach.
  float reach_of(const Model& model) const {
    return reach + (slides ? static_cast<float>(most_above_samples(model)) : 0.0f);
  }
};

/// One of the two shells in the other side's field.
struct ContactSearch::PosedShell {
  const Side& own;
  const Side& other;
  Pose field_from_shell;
  bool is_of_field;  ///< it is the shell of the pair's field side

  static PosedShell first_of(const PosedPair& pair) {
    return {pair.shell_side(), pair.field_side(), pair.field_from_shell(), false};
  }
  static PosedShell second_of(const PosedPair& pair) {
    return {pair.field_side(), pair.shell_side(), pair.field_from_shell().inverse(), true};
  }
  const Model& model() const { return *own.model(); }
  const PointShell& shell() const { return *own.participant().shell; }
  const Field& field() const { return *other.participant().field; }
};

bool ContactSearch::find_near(const ContactSettings& settings, PosedPair& pair, double margin,
                              const PairStep* step, Wanted wanted) {
  Question question(settings, pair, margin, step, wanted);
  contacts_.clear();
  exact_.clear();
  features_.clear();
  if (pair.has_triangles()) {
    const std::vector<Contact>& found =
        triangle_contacts_.find(*pair.shell_side().triangles(), *pair.field_side().model(),
                                pair.field_from_shell(), question.level, question.reach);
    contacts_.assign(found.begin(), found.end());
    return false;
  }
  Opposition opposition;
  hits_.clear();
  if (may_touch(question, pair)) take_all(question, pair, opposition);
  bool has_swapped_roles = false;
  if (settings.shell == ShellRule::kFewest && !pair.asks_both && contacts_.empty()) {
    has_swapped_roles = pair.swap_roles_if_enclosed();
  }
  if (has_swapped_roles) {
    question.slides = false;
    take(question, PosedShell::first_of(pair), first_, contacts_, opposition);
  }
  if (settings.shell == ShellRule::kAutomatic) append_inner(pair, step, opposition);
  append_features(question, pair);
  if (pair.asks_both && step != nullptr) {
    second_shell_.drop_doubles(static_cast<float>(step->rest_margin), contacts_);
  }
  return has_swapped_roles;
}

void ContactSearch::follow(const PosedPair& pair) {
  const auto go_on = [&](const PosedShell& posed, OfShell& of) {
    const std::uint32_t first_id = posed.is_of_field ? kFirstOfSecond : 0;
    moved_.clear();
    of.round.follow(contacts_, first_id, SmoothField(posed.other), posed.field_from_shell, moved_);
    of.on_round.follow(contacts_, first_id, posed.other, posed.field_from_shell, moved_);
    for (const Contact& contact : moved_) {
      contacts_[find_from_id(contacts_, first_id + contact.id)] =
          posed.is_of_field ? turn_over(contact, posed.field_from_shell) : contact;
    }
  };
  go_on(PosedShell::first_of(pair), first_);
  if (pair.asks_both) go_on(PosedShell::second_of(pair), second_);
}

/// Whether points of two models may be so near that they touch within the step. Bodies that fall
/// are looked for farther away, and most of them in vain.
bool ContactSearch::may_touch(const Question& question, const PosedPair& pair) {
  const PairStep* step = question.step;
  const bool are_models = pair.a.model() != nullptr && pair.b.model() != nullptr;
  if (step == nullptr || !are_models || step->margin <= step->touch_margin) return true;
  const double reach = step->touch_margin + step->thickness + most_above_samples(*pair.a.model()) +
                       most_above_samples(*pair.b.model());
  const auto is_near = [&](const PosedShell& posed) {
    return collides(posed.field(), posed.shell(), posed.field_from_shell,
                    static_cast<float>(reach));
  };
  return is_near(PosedShell::first_of(pair)) ||
         (pair.asks_both && is_near(PosedShell::second_of(pair)));
}

/// Finds those of the shells that the pair asks.
void ContactSearch::take_all(const Question& question, const PosedPair& pair,
                             Opposition& opposition) {
  const PosedShell first = PosedShell::first_of(pair);
  take(question, first, first_, contacts_, opposition);
  hits_.assign(first_.hits.ids().begin(), first_.hits.ids().end());
  if (!pair.asks_both) {
    if (question.slides) {
      first_.gather_exact(exact_);
      first_.on_round.drop_covered(contacts_, /*are_of_field=*/false, exact_);
      first_.on_round.drop_covered(first_.guards, /*are_of_field=*/false, {});
    }
    merge_by_id(first_.guards, contacts_);
    return;
  }
  const PosedShell second = PosedShell::second_of(pair);
  take(question, second, second_, second_found_, opposition);
  for (const std::uint32_t id : second_.hits.ids()) hits_.push_back(kFirstOfSecond + id);
  if (question.slides) drop_covered_by_each_other(first, second);
  merge_by_id(first_.guards, contacts_);
  merge_by_id(second_.guards, second_found_);
  second_shell_.append(second_found_, second.field_from_shell, contacts_);
}

/// Finds the samples of one shell, ascending by id.
void ContactSearch::find_samples(const Question& question, const PosedShell& posed, OfShell& of,
                                 std::vector<Contact>& contacts) {
  const PairStep* step = question.step;
  const float near = question.reach_of(posed.model());
  of.scratch.borrow(lists_of_this_thread());
  const auto find_one_a_segment = [&](int level) {
    std::optional<Arrivals> arrivals;
    if (question.slides && step->looks_ahead() && step->restitution == 0.0 &&
        posed.other.model() != nullptr) {
      arrivals.emplace(*step, posed.is_of_field,
                       static_cast<double>(near) - step->margin + step->rest_margin);
    }
    return find_deepest_per_segment(posed.field(), posed.shell(), posed.field_from_shell, level,
                                    near, of.scratch,
                                    arrivals ? arrivals->all() : std::span<const Arrival>{});
  };
  if (question.wanted == Wanted::kOneASegment) {
    const std::span<const Contact> found = find_one_a_segment(question.level);
    contacts.assign(found.begin(), found.end());
    return;
  }
  const double ahead = step != nullptr ? step->margin - step->rest_margin : 0.0;
  const std::span<const Contact> found =
      find_contacts(posed.field(), posed.shell(), posed.field_from_shell,
                    {.margin = near - static_cast<float>(ahead)}, of.scratch);
  contacts.assign(found.begin(), found.end());
  // What is farther away touches only if something stops one of the bodies.
  if (ahead > 0.0) merge_by_id(find_one_a_segment(level_of(question.settings, true)), contacts);
}

/// Finds those of one shell, ascending by id, with the normals and depths that they touch with.
void ContactSearch::take(const Question& question, const PosedShell& posed, OfShell& of,
                         std::vector<Contact>& contacts, Opposition& opposition) {
  const PairStep* step = question.step;
  const Pose& field_from_shell = posed.field_from_shell;
  find_samples(question, posed, of, contacts);
  of.hits.clear();
  if (step != nullptr && step->uses_ccd && question.wanted == Wanted::kOneASegment) {
    of.hits.find(*step, posed.shell(), posed.field(), posed.is_of_field, question.level,
                 lists_of_this_thread(), contacts);
  }
  part_from_guards(question, posed, contacts, of.guards);
  face_elements(contacts, posed.field(), posed.shell(), field_from_shell,
                posed.other.has_sharp_field() ? question.touch.margin : 0.0,
                posed.own.thickness() + posed.other.thickness());
  if (question.slides) {
    of.on_round.slide(contacts, posed.model(), posed.other, field_from_shell, question.touch,
                      own_turning_of(*step, posed.is_of_field),
                      turning_of(*step, !posed.is_of_field));
  }
  of.flat.align(contacts, posed.field(), posed.shell(), posed.model().grid(), field_from_shell,
                question.touch);
  const bool are_sharp = posed.own.has_sharp_field() && posed.other.has_sharp_field();
  if (question.slides && are_sharp && !(step->restitution > 0.0)) {
    cross_edges(contacts, posed.own, posed.other, field_from_shell,
                std::max(double{question.touch.margin}, step->farthest_displacement));
    // Bodies at rest lie on all places that they touch with.
    if (!step->is_still) {
      const Turning turning = turning_of(*step, posed.is_of_field);
      std::erase_if(contacts, [&](const Contact& contact) {
        const Contact of_first =
            posed.is_of_field ? turn_over(contact, posed.field_from_shell) : contact;
        return is_gentle(*step, impact_of(*step, of_first)) &&
               is_behind_face(contact, posed.own, turning, step->rest_margin);
      });
    }
  }
  if (step != nullptr && question.settings.mode != ContactMode::kSegmented) {
    for (std::vector<Contact>* each : {&contacts, &of.guards}) {
      drop_from_behind(*each, posed.shell(),
                       static_cast<float>(step->rest_margin + step->thickness),
                       static_cast<float>(step->deep_overlap), opposition);
    }
  }
  if (!question.slides) return;
  // What a still body does not lie on is left out later, too.
  float least_depth = -question.reach;
  if (!contacts.empty() && step->is_still && question.wanted == Wanted::kAll) {
    const float band = kIdleOfMargin * static_cast<float>(step->rest_margin);
    least_depth = std::max(std::min(find_deepest(contacts).depth - band, 0.0f), least_depth);
  }
  of.round.slide(contacts, posed.model(), SmoothField(posed.other), field_from_shell,
                 question.touch, turning_of(*step, posed.is_of_field), least_depth);
  of.round.drop_guards(of.guards, question.touch, turning_of(*step, posed.is_of_field));
  keep_if(contacts, [&](const Contact& contact) { return contact.depth > -question.reach; });
}

/// Moves those to `guards` that touch neither within the step nor at twice their speed. The solver
/// may make a place faster in a step with CCD, and guards stop it then; samples are good enough for
/// that.
void ContactSearch::part_from_guards(const Question& question, const PosedShell& posed,
                                     std::vector<Contact>& contacts, std::vector<Contact>& guards) {
  guards.clear();
  if (!question.slides || !question.step->looks_ahead()) return;
  const double above = most_above_samples(posed.model());
  std::erase_if(contacts, [&](const Contact& contact) {
    const Contact of_first =
        posed.is_of_field ? turn_over(contact, posed.field_from_shell) : contact;
    if (may_reach(*question.step, of_first, above)) return false;
    guards.push_back(contact);
    return true;
  });
}

/// Drops contacts of either shell that are samples of what the other one's touch.
void ContactSearch::drop_covered_by_each_other(const PosedShell& first, const PosedShell& second) {
  first_.gather_exact(exact_);
  second_.gather_exact(second_exact_);
  const auto drop = [&](std::vector<Contact>& of_first, std::vector<Contact>& of_second,
                        std::span<const std::uint32_t> exact,
                        std::span<const std::uint32_t> second_exact, bool are_guards) {
    first_.on_round.drop_covered(of_first, /*are_of_field=*/false, exact);
    first_.on_round.drop_covered(of_second, /*are_of_field=*/true, second_exact);
    second_.on_round.drop_covered(of_second, /*are_of_field=*/false, second_exact);
    second_.on_round.drop_covered(of_first, /*are_of_field=*/true, exact);
    first_.round.drop_covered(of_second, second.shell(), second_exact, contacts_,
                              first.field_from_shell, are_guards);
    second_.round.drop_covered(of_first, first.shell(), exact, second_found_,
                               second.field_from_shell, are_guards);
  };
  drop(contacts_, second_found_, exact_, second_exact_, /*are_guards=*/false);
  drop(first_.guards, second_.guards, {}, {}, /*are_guards=*/true);
  for (const std::uint32_t id : second_exact_) exact_.push_back(kFirstOfSecond + id);
}

/// Those of features of Bullet's shapes.
void ContactSearch::append_features(const Question& question, const PosedPair& pair) {
  find_features(pair, features_);
  if (features_.empty()) return;
  if (features_.front().radius > 0.0) {
    balls_.append(features_, pair, question.step, question.reach,
                  question.slides ? question.touch : TouchScale{}, contacts_, exact_);
    if (question.slides) balls_.drop_covered(contacts_, pair.shell(), exact_);
  } else {
    append_feature_contacts(features_, pair, question.reach, contacts_);
    if (question.slides && question.step->uses_ccd) {
      append_walls_ahead(*question.step, features_, contacts_);
    }
    if (question.slides) first_.on_round.slide_features(contacts_, features_, exact_);
    std::ranges::sort(exact_);
  }
  if (question.slides) {
    cylinder_.slide(features_, *question.step, question.reach, question.touch, contacts_, exact_);
  }
}

void ContactSearch::append_inner(const PosedPair& pair, const PairStep* step,
                                 const Opposition& opposition) {
  if (step != nullptr) {
    append_way_out(*step, opposition);
    return;
  }
  if (!contacts_.empty()) return;
  auto inner = find_enclosed(pair);
  if (!inner) inner = find_piercing(pair, pair.field_from_shell(), 0.0);
  if (!inner) return;
  inner->id = kInnerContact;
  // Where no direction is better than another, one that is the same in every step.
  if (inner->normal == Vec3f{}) inner->normal = {0, 0, 1};
  contacts_.push_back(*inner);
}

/// Of bodies deep in each other whose contacts tell no way out.
void ContactSearch::append_way_out(const PairStep& step, const Opposition& opposition) {
  const PosedPair& pair = *step.pair;
  const auto is_deep = [&](const Contact& contact) {
    return static_cast<double>(contact.depth) + step.thickness > step.deep_overlap;
  };
  if (std::ranges::any_of(contacts_, is_deep)) return;
  const bool is_deep_inside = static_cast<double>(opposition.buried) > step.deep_overlap ||
                              find_piercing(pair, pair.field_from_shell(), step.deep_overlap) ||
                              (!opposition.is_opposed && find_enclosed(pair));
  if (!is_deep_inside) return;
  const auto way = find_way_out(pair, kWayOutPrecision * step.deep_overlap);
  if (!way) return;
  const Vec3 place =
      pair.shell_side().world_from_geometry().inverse().transform_point(middle_of_lighter(step));
  // Others are of rims, and push to all sides.
  contacts_.assign(1, {kInnerContact, static_cast<float>(way->distance), static_cast<Vec3f>(place),
                       static_cast<Vec3f>(way->direction)});
}

double ContactSearch::find_on_the_way(const ContactSettings& settings, const PairStep& step) {
  const PosedPair& pair = *step.pair;
  const Model& model = *pair.field_side().model();
  const double farthest = step.farthest_displacement;
  const auto reach = [&](double fraction) {
    return static_cast<float>((1.0 - fraction) * farthest + step.rest_margin + step.thickness);
  };
  contacts_.clear();
  features_.clear();
  triangle_contacts_.gather(*pair.shell_side().triangles(), model, pair.field_from_shell(),
                            reach(0.0));
  const auto touch = advance(farthest, step.touching_gap(), 1.0, [&](double fraction) {
    const double gap =
        triangle_contacts_.distance(model, step.field_from_shell_after(fraction), reach(fraction)) -
        step.thickness;
    return Clearance{gap, kSafeOfGap * gap};
  });
  if (!touch) return 0.0;
  const double fraction = touch->fraction;
  const std::vector<Contact>& found = triangle_contacts_.find(
      model, step.field_from_shell_after(fraction), level_of(settings, step.uses_ccd),
      reach(fraction), kPlaneBeyondGaps * static_cast<float>(step.touching_gap()));
  contacts_.assign(found.begin(), found.end());
  return fraction;
}

}  // namespace voxshell::bullet

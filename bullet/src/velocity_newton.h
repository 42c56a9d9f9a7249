#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace voxshell::bullet {

/// One direction in which two bodies are kept from moving, and the impulse that does so.
///
/// Velocities of bodies are scaled by the square roots of mass and inertia, three of translation
/// and three of rotation, so that the kinetic energy is half of the sum of their squares.
struct VelocityRow {
  static constexpr int kFixed = -1;

  int body_a = kFixed;  ///< number of the body, or kFixed where it cannot move
  int body_b = kFixed;
  std::array<double, 6> along_a{};  ///< change of a's scaled velocity by a unit impulse
  std::array<double, 6> along_b{};
  double target = 0.0;        ///< velocity along the row that is aimed at
  double softness = 0.0;      ///< velocity per impulse by which the row gives way; not friction
  double impulse = 0.0;       ///< where a solve starts and ends
  double unit_impulse = 0.0;  ///< changes the velocity along this row alone by 1
  double lower = 0.0;         ///< limits of the impulse; not of contacts and their friction
  double upper = 0.0;
  bool is_contact = false;  ///< a contact's normal; its friction is in the rows that follow
  int friction_rows = 0;    ///< how many, 0 to 2
  double friction = 0.0;    ///< their largest impulse per impulse of the normal
};

/// Finds the velocities of all bodies of an island that fit all of its rows, at once.
///
/// Newton's method on the augmented Lagrangian of the velocities, a smooth convex function of six
/// numbers a body. It takes about as many steps whatever the ratio of masses, whereas sweeps from
/// row to row need as many as that ratio. Contacts are cones of impulses, so a contact that slides
/// also opens, by friction times the speed of sliding; `target` can correct for that.
class VelocityNewton {
 public:
  /// Orders the bodies so that the matrix is narrow.
  ///
  /// @return Multiplications to factorize the matrix.
  double prepare(std::size_t body_count, std::span<const VelocityRow> rows);

  /// Finds the impulses of the rows that were prepared, from those that they have.
  ///
  /// @param stiffness Impulse by which a row answers to a violation, in units of its unit impulse.
  /// @return Whether `most_steps` were enough. If not, the rows keep the impulses that they have:
  ///         those of velocities that are no solution are off by as much as the stiffness times
  ///         what the velocities are off.
  bool solve(std::span<VelocityRow> rows, double stiffness, int most_steps);

  /// The largest velocity by which the impulses of the rows that were prepared miss the solution.
  ///
  /// A row's error is the step along it that a projection on its limits leaves (the natural map).
  double error(std::span<const VelocityRow> rows);

 private:
  void order(std::size_t body_count, std::span<const VelocityRow> rows);
  /// What projecting reads of a row, close together: line searches project again and again.
  struct Aim {
    double impulse;
    double target;
    double divisor;
  };
  /// The same of a contact with its friction, or of one other row.
  struct Group {
    std::size_t first;  ///< of its rows
    std::size_t count;
    double impulse;  ///< by which its rows answer to a velocity along them of 1
    double lower;
    double upper;
    double friction;
    double scale;  ///< of a contact's normal impulse, so that a cone's nearest place is that of the
                   ///< least work: 1 if it does not give way
    bool is_contact;
  };

  void start(std::span<const VelocityRow> rows, double stiffness);
  double find_gradient(std::span<const VelocityRow> rows);
  void find_direction(std::span<const VelocityRow> rows);
  void assemble(std::span<const VelocityRow> rows);
  void add_contact(std::span<const VelocityRow> rows, std::size_t normal);
  void add_square(const VelocityRow& row, double factor);
  void factorize();
  void substitute();
  double search_line();
  double slope_of_bodies_at(double fraction) const;
  double slope_at(double fraction) const;
  double slope_of_pressed_at(double fraction);
  void project_all(double fraction);
  void find_pressed();
  void project(const Group& group, double fraction);
  void project_contact(const Group& contact);
  double friction_at(std::size_t normal, std::size_t count) const;

  double stiffness_ = 0.0;
  std::vector<Aim> aims_;                ///< one a row
  std::vector<Group> groups_;            ///< of all rows
  std::size_t size_ = 0;                 ///< six times the number of bodies
  std::vector<std::size_t> offset_;      ///< of each body's six numbers in vectors of that size
  std::vector<std::size_t> last_;        ///< column of the last entry in each row of the matrix
  std::vector<std::size_t> row_starts_;  ///< where column 0 of each row of the matrix would be
  std::size_t entry_count_ = 0;     ///< of the matrix, from each row's diagonal to its last entry
  std::vector<double> matrix_;      ///< upper half by rows, then its factor
  std::vector<double> velocities_;  ///< scaled, of the bodies
  std::vector<double> direction_;   ///< gradient, then step, of the velocities
  std::vector<double> along_;       ///< velocity along each row
  std::vector<double> along_step_;  ///< its change by the whole step
  std::vector<double> unlimited_;   ///< impulses before limits are applied
  std::vector<double> impulses_;    ///< and after
  std::vector<double> before_;      ///< the same where all rows were projected before
  std::vector<std::uint32_t> pressed_;  ///< groups that a line search looks at
};

}  // namespace voxshell::bullet

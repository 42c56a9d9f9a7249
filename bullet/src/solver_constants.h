#pragma once

#include <cstddef>

#include <LinearMath/btScalar.h>

/// The numbers of CoulombSolver. Decision 34 (docs/decisions/0034-loads.md) argues them.

namespace voxshell::bullet {

/// An island is solved when no row's velocity changes in a sweep by more than this fraction of the
/// velocity that forces give a body in a step. Larger: chains under load open and grips slip.
/// Smaller: more rounds in which nothing visible changes.
inline constexpr double kConvergedOfForces = 2e-4;
/// A contact rebounds if it is to leave faster than by this fraction of its bodies' speeds, and
/// than forces move bodies in the step. Smaller: rounding errors count as rebounds, in float first,
/// and without gravity, islands keep to ten sweeps. Larger: rebounds at low restitution are missed.
inline constexpr btScalar kRoundingOfSpeed = btScalar(1e-6);
/// Most rounds of Newton's method for an island and step. Smaller: chains open whose load is a
/// thousand times a link. Larger: islands that do not converge cost more.
inline constexpr int kMostRounds = 16;
/// The same of islands of more than `kFewBodies`. Smaller: heavy loads that arrive at speed squeeze
/// what they land on. Larger: heaps cost more.
inline constexpr int kMostRoundsOfMany = 8;
/// A round has brought an island nearer to its solution if it leaves at most this fraction of the
/// least error before. Larger: heaps that tumble cost more.
inline constexpr double kProgress = 0.7;
/// Rounds end when this many in a row have not. Larger: heaps cost more.
inline constexpr int kMostIdleRounds = 2;
/// The same of islands of up to `kFewBodies` whose error is above `kSmallOfForces`. Smaller: the
/// impulses of a chain creep for several rounds before the error drops.
inline constexpr int kMostIdleRoundsOfHard = 5;
/// Rounds before sliding is corrected for. They take all contacts to stick where they can.
/// Smaller: a grip that could hold goes on sliding.
inline constexpr int kStickingRounds = 3;
/// None of them if contacts of bodies that joints connect are then pressed by more than this many
/// times what sweeps had pressed them by. Larger: doors stick.
inline constexpr double kMostBracing = 1.5;
/// Depth by which the contacts of two bodies that joints connect give way at the largest force,
/// relative to half the diagonal of the smaller body's box. Smaller: doors stick to the ground that
/// their hinges press them on by a micrometer, and to be pressed on it by more takes any force.
/// Larger: motors press bodies into each other.
inline constexpr double kBracedDepth = 1e-4;
/// Sweeps after each round. They leave friction that is exactly Coulomb's.
inline constexpr int kSweepsAfterRound = 3;
/// Newton's steps a solve at most; a thousand contacts that slide apart need up to 75. Smaller: a
/// load that arrives squeezes out what it lands on, and stacks that fall apart are left to sweeps.
inline constexpr int kMostNewtonSteps = 100;
/// The same of islands of more than `kFewBodies`. If the first solve of such an island needs more,
/// too many contacts open and close for the method to pay. Larger: heaps that tumble cost more.
inline constexpr int kMostNewtonStepsOfMany = 8;
/// Solves a round. Each takes the impulses of the one before as known, and errors shrink by the
/// stiffness.
inline constexpr int kSolvesPerRound = 2;
/// Stiffness of violated rows in the first round, relative to what they act on; 4 times as much in
/// each later one, up to the largest. Larger at first: more steps for contacts that open or close.
/// Smaller: more rounds for ratios of masses.
inline constexpr double kFirstStiffness = 1e2;
inline constexpr double kStiffnessGrowth = 4.0;
inline constexpr double kLargestStiffness = 1e4;
/// Squared gradient, relative to the squared velocities, at which Newton's method has converged.
/// The gradient is by how much velocities differ from those that the impulses give. Relative to the
/// gradient at the start, as is common, it would say nothing: that one grows with the stiffness and
/// the number of contacts. Larger: rounds on many contacts diverge. Smaller: below what rounding
/// leaves.
inline constexpr double kConvergedGradient = 1e-16;
/// The line search ends where the slope is this fraction of that at its start.
inline constexpr double kFlatSlope = 0.1;
/// Islands whose matrix takes more multiplications than this to factorize keep to sweeps. Larger:
/// heaps are slower. Smaller: towers of some tens of bodies rock.
inline constexpr double kMostCost = 3e4;
/// So many for each row of a joint are always worth it: sweeps do not solve robots of many links.
/// Smaller: hands of more than twenty joints move wrongly. Larger: heaps on robots are slower.
inline constexpr double kMostCostOfJointRow = 2e3;
/// Rows of a joint, which holds one body to another, at least.
inline constexpr std::size_t kRowsOfJoint = 5;
/// Islands of more bodies than this get fewer steps and rounds. Larger: heaps that tumble cost
/// more. Smaller: towers that fall apart are left to sweeps.
inline constexpr std::size_t kFewBodies = 12;
/// An error is small if it is at most this fraction of the velocity that forces give a body.
inline constexpr double kSmallOfForces = 0.1;
/// Sweeps of islands that Newton's method is not for or has not solved, unless they converge
/// sooner. Smaller: stacks of few bodies sag.
inline constexpr int kMostSweeps = 50;
/// The same of islands of more than `kFewBodies`, whose sweeps follow conjugate directions.
/// Smaller: heaps and walls creep, so that contacts are searched for again. Larger: heaps that
/// tumble cost more.
inline constexpr int kMostSweepsOfMany = 100;
/// Bodies that joints pull on follow a swing if their inertia is at least this fraction of the
/// geometric stiffness times the squared time step. Smaller: hanging chains fly apart, those with
/// 50 kg at a quarter. Larger: light links swing slower than they should.
inline constexpr double kFollowedStiffness = 0.5;
/// Bodies are squeezed if the split impulses that join them do less than this fraction of the work
/// that they ask for: all of it where bodies can leave what they are in, and the impulses are
/// solved; nothing between two fingers. Larger: what lies in a narrow groove is squeezed.
inline constexpr double kSqueezedWork = 0.5;
/// And if the momentum that these impulses give to bodies is less than this fraction of the
/// impulses by bodies that cannot move. At least all of it where bodies can be pushed upward,
/// however heavy, and however far from solved the impulses are. Larger: heavy bodies sink into
/// light ones. Smaller: loose grips count as none.
inline constexpr double kSqueezedMomentum = 0.2;
/// Frequency, rad/s, at which a contact of a squeezed body would swing on its spring. At this one,
/// a depth of 0.1 mm presses with about 50 times the weight. Larger: islands are harder to solve.
/// Smaller: grips slip that penetrate by little.
inline constexpr double kSqueezeFrequency = 3000.0;
/// Fraction of its depth, 1/s, by which the spring of a contact goes back in a second, if nothing
/// holds it. Larger: what slips out of a squeeze leaves faster. Smaller: squeezed bodies take
/// longer to come to the middle.
inline constexpr double kSqueezeRate = 10.0;

}  // namespace voxshell::bullet

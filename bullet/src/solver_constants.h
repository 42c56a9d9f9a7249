#pragma once

/// The numbers of CoulombSolver. Decision 34 (docs/decisions/0034-loads.md) argues them.

namespace voxshell::bullet {

/// An island is solved when no row's velocity changes in a sweep by more than this fraction of the
/// velocity that forces give a body in a step. Larger: chains under load open and grips slip.
/// Smaller: more rounds in which nothing visible changes.
inline constexpr double kConvergedOfForces = 2e-4;
/// Most rounds of Newton's method for an island and step. Smaller: heavy loads that arrive at speed
/// squeeze what they land on. Larger: islands that do not converge cost more.
inline constexpr int kMostRounds = 8;
/// Rounds end when this many in a row have brought the island no nearer to its solution.
inline constexpr int kMostIdleRounds = 3;
/// Rounds before sliding is corrected for. They take all contacts to stick where they can.
/// Smaller: a grip that could hold goes on sliding.
inline constexpr int kStickingRounds = 3;
/// Sweeps after each round. They leave friction that is exactly Coulomb's.
inline constexpr int kSweepsAfterRound = 3;
/// Newton's steps a solve at most; a handful suffices unless many contacts open or close.
inline constexpr int kMostNewtonSteps = 20;
/// Solves a round. Each takes the impulses of the one before as known, and errors shrink by the
/// stiffness.
inline constexpr int kSolvesPerRound = 2;
/// Stiffness of violated rows in the first round, relative to what they act on; 4 times as much in
/// each later one, up to the largest. Larger at first: more steps for contacts that open or close.
/// Smaller: more rounds for ratios of masses.
inline constexpr double kFirstStiffness = 1e2;
inline constexpr double kStiffnessGrowth = 4.0;
inline constexpr double kLargestStiffness = 1e4;
/// Squared gradient, relative to the first, at which Newton's method has converged.
inline constexpr double kConvergedGradient = 1e-10;
/// The line search ends where the slope is this fraction of that at its start.
inline constexpr double kFlatSlope = 0.1;
/// Islands whose matrix costs more multiplications than this for each row keep to sweeps.
inline constexpr double kMostCostOfRow = 1e3;
/// Sweeps of such islands, unless they converge sooner.
inline constexpr int kSweepsOfLargeIslands = 50;

}  // namespace voxshell::bullet

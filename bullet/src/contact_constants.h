#pragma once

#include <cstddef>

/// Every number that the adapter's contacts depend on and that neither Bullet nor a user gives. A
/// comment says the unit, the reason, and what breaks when the number changes. Decision 3
/// (docs/decisions/0003-contact-rule.md) argues them unless another decision is named.
///
/// Numbers of the geometry that queries rest on are not among them: those of triangles stand in
/// triangle_contacts.cpp, those of hulls in hull.cpp.

namespace voxshell::bullet {

// ---- rest margin --------------------------------------------------------------------------------

/// Default rest margin as a fraction of the smaller body's diameter. Smaller: resting bodies lose
/// and find their contacts in turn and rock. Larger: bodies visibly float.
inline constexpr double kRestMarginOfDiameter = 1e-3;
/// Most of it as a fraction of the thinner body's thickness. Larger: both sides of a plate come
/// within the margin, and it rests on either. Decision 26.
inline constexpr double kRestMarginOfThickness = 0.05;

// ---- continuous collision detection (CCD) -------------------------------------------------------

/// A pair needs CCD where it moves in a step by more than this fraction of a model's thickness.
/// Larger: a body may pass the middle of a wall in one step, and is pushed out of its far side.
inline constexpr double kCcdOfThickness = 0.4;
/// The same as a fraction of a model's longest side. Larger: bodies penetrate visibly before they
/// stop. Of a 20th, rebounds of a ball of 0.2 m were no longer those of its restitution. Decision
/// 26.
inline constexpr double kCcdOfSize = 0.02;
/// The same as a fraction of the diameter of the ball that fits into a shape of Bullet's.
inline constexpr double kCcdOfInnerDiameter = 0.125;
/// In steps with CCD, points count up to this many times the farthest displacement, because the
/// solver may make a point faster than it is: an impulse at one end of a rod turns it about its
/// middle. Smaller: the other end of a rod that falls flat goes into the ground. Larger: slower.
inline constexpr double kCcdReach = 2.0;
/// Surfaces touch where they are nearer than this fraction of the pair's finest detail. Smaller:
/// more steps of conservative advancement. Larger: fast bodies stop visibly early.
inline constexpr double kTouchingOfDetail = 0.05;
/// Triangles farther from the model than this many touching gaps where the model first touches
/// count as planes. Decision 13.
inline constexpr float kPlaneBeyondGaps = 2.0f;

// ---- rebound ------------------------------------------------------------------------------------

/// Contacts that touch within this fraction of the step after the first one rebound as well; later
/// ones only stop approaching. Larger: ten iterations of the solver leave a body that lands on
/// several points with too much energy. 0: only one of the points of a flat landing rebounds.
inline constexpr double kFirstTouchWithin = 0.05;
/// The fraction of the last step's impulses that Bullet's solver starts from: the default of
/// btContactSolverInfo::m_warmstartingFactor. Another value there than here: still bodies rock.
inline constexpr double kWarmStartingFactor = 0.85;

// ---- rest ---------------------------------------------------------------------------------------

/// A pair is still if its kinetic energy could lift it by at most this fraction of the rest margin.
/// Larger: a ball that rolls slowly is stopped. Smaller: bodies on rounded bellies rock for longer.
inline constexpr double kStillOfMargin = 0.15;
/// Points of a still body carry it if they are farther from the surface than the nearest by at most
/// this fraction of the rest margin. Smaller: bodies tip from one set of points to the next.
inline constexpr double kPatchOfMargin = 0.5;
/// Points that carried the body before do so up to this many times that. 1: bodies rock about the
/// patch's edge.
inline constexpr double kPatchHeldWithin = 2.0;
/// The fraction of what a point has moved since that the patch forgets in each step. 0: errors of
/// the solver add up to a tilt of the patch that the body is then held to. 1: there is no patch.
inline constexpr double kPatchForgets = 0.01;
/// Contacts of a still body that are farther from the surface than the nearest by this fraction of
/// the rest margin are left out. Larger: they span the largest area, and the ones that carry the
/// body go without a place in the manifold.
inline constexpr float kIdleOfMargin = 0.2f;
/// A manifold keeps its points while none is deeper by more than this fraction of the rest margin.
/// 0: points change from step to step, and bodies rock. Larger: bodies rest on shallow points.
inline constexpr float kCarriesOnOfMargin = 0.25f;
/// A manifold with as many points as this need not look for more.
inline constexpr std::size_t kCarryingPoints = 3;
/// On at most this many segments each has up to four points, as a body may rest on several points
/// of one segment. Larger: more contacts than the solver needs.
inline constexpr std::size_t kFewSegments = 4;
/// Friction holds a pair while some point has slipped by at most this fraction of the rest margin.
/// Larger: a body on a slope creeps farther before it slides.
inline constexpr double kHeldOfMargin = 1.0 / 30.0;
/// The fraction of its slip that a held point is pulled back by in a step. 1: bodies on four points
/// rest less calmly.
inline constexpr double kPulledBack = 0.75;
/// Patches that are smaller than this fraction of the smaller body's radius resist rolling: the
/// solver's iterations hardly feel levers that are short beside the body. Larger: bodies that stand
/// on an edge do not tip.
inline constexpr double kSmallPatchOfRadius = 0.1;

// ---- side contacts ------------------------------------------------------------------------------

/// A contact may lie beside the other body if the normals of the two surfaces oppose each other by
/// less than this cosine.
inline constexpr float kOpposedByLess = -0.3f;
/// It does if the shell's own surface is nearer than this to a place one spacing in front of it, in
/// spacings.
inline constexpr float kFreeInFront = 0.3f;

// ---- facing normals -----------------------------------------------------------------------------

/// Normals of surfaces that touch have at most this cosine: within eight degrees.
inline constexpr float kFacingCosine = -0.99f;
/// Contacts outside by more than this many reaches lie beside the field's body, not along its rim.
inline constexpr double kFacingOutside = 0.1;
/// Contacts deeper than this many reaches keep their normals.
inline constexpr double kFacingInside = 8.0;
/// How often the reach is doubled to get out of the field: up to kFacingInside.
inline constexpr int kFacingDoublings = 3;

// ---- both shells --------------------------------------------------------------------------------

/// A contact of the second shell is a double if its normal and that of one of the first have at
/// least this cosine: within ten degrees. Decision 26.
inline constexpr float kDoubleCosine = 0.985f;

// ---- segments -----------------------------------------------------------------------------------

/// Level of the segments, up to 64.
inline constexpr int kDefaultLevel = 4;
/// The same in steps with CCD: a body that turns while it is stopped is held by more points.
inline constexpr int kDefaultCcdLevel = 5;

}  // namespace voxshell::bullet

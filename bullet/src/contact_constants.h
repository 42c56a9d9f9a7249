#pragma once

#include <array>
#include <cstddef>

/// Every number that the adapter's contacts depend on and that neither Bullet nor a user gives. A
/// comment says the unit, the reason, and what breaks when the number changes. Decisions 3, 50
/// (CCD), 51 (guards), 52 (rest) and 53 (rebound) argue them unless another decision is named.

namespace voxshell::bullet {

// ---- rest margin --------------------------------------------------------------------------------

/// Default rest margin as a fraction of the smaller body's diameter. Smaller: resting bodies lose
/// and find their contacts in turn and rock. Larger: bodies visibly float.
inline constexpr double kRestMarginOfDiameter = 1e-3;
/// Most of it as a fraction of the thinner body's thickness. Larger: both sides of a plate come
/// within the margin, and it rests on either. Decision 26.
inline constexpr double kRestMarginOfThickness = 0.05;

// ---- continuous collision detection (CCD) -------------------------------------------------------

/// The finest detail of a body, as a fraction of a model's thickness. Larger: a body may pass the
/// middle of a wall in one step, and is pushed out of its far side.
inline constexpr double kDetailOfThickness = 0.4;
/// The same as a fraction of a model's longest side, or of the diameter of the ball about a shape
/// of Bullet's. Larger: bodies climb low steps. Of a 20th, rebounds of a ball of 0.2 m were no
/// longer those of its restitution. Decision 26.
inline constexpr double kDetailOfSize = 0.02;
/// The same as a fraction of the diameter of the ball that fits into a shape of Bullet's.
inline constexpr double kDetailOfInnerDiameter = 0.125;
/// A pair needs CCD where it moves in a step by more than this fraction of the finer body's detail.
/// Smaller: bodies that slide slowly have a contact on each segment, and Bullet's own solver gives
/// them too much friction. Larger: bodies are that much deeper where they land, and come out within
/// a tenth of a second. Decision 50.
inline constexpr double kCcdOfDetail = 0.25;
/// In steps with CCD, points count up to this many times the farthest displacement, because the
/// solver may make a point faster than it is: an impulse at one end of a rod turns it about its
/// middle. Smaller: the other end of a rod that falls flat goes into the ground. Larger: slower.
inline constexpr double kCcdReach = 2.0;
/// Without restitution, an impulse at one end of a rod makes its other end faster by at most this
/// fraction, and those of wider bodies by less. Smaller: rods that fall flat go into the ground.
/// Larger: slower.
inline constexpr double kAddedOfDisplacement = 0.5;
/// Balls of Bullet's are looked at in places of their way that are as many radii apart, and corners
/// that touch something in places as many thicknesses of the model apart. Larger: they pass thin
/// walls. Smaller: slower.
inline constexpr double kBallHop = 0.5;
/// And in at most so many places. Smaller: tiny ones that are fast pass walls. Larger: slower.
inline constexpr double kMostBallHops = 64.0;
/// How often the hop in which a ball meets a wall is halved. Fewer: the place is off by more.
inline constexpr int kMeetSteps = 12;
/// Of a hop, by which the wall is looked at behind that place, where the grid no longer blends its
/// normal with that of a nearer one.
inline constexpr double kBehindMeeting = 0.5;
/// Walls that a ball meets on its way at most. Fewer: a ball that crosses a bin several times
/// within a step leaves it.
inline constexpr int kMostWalls = 3;
/// Radians by which a pair turns in a step, beyond which points are looked for twice as far away as
/// the smaller body moves. Larger: turning takes points from farther away than they are looked for.
inline constexpr double kMostReachingTurn = 0.5;
/// What touches a plane is of a round surface that faces it if its normal has at least this cosine
/// with the plane's: within 30 degrees. Smaller: places beside an edge count as ones on it. Larger:
/// samples that are not the deepest are followed as if they were, and brake what rolls.
inline constexpr double kFacesPlane = 0.866;
/// The same of an edge, and of the normal that the place has: within 60 degrees.
inline constexpr double kFacesEdge = 0.5;
/// Places of a flat face that are nearer to its rim than this fraction of the smaller body's
/// radius, and of the thickness, touch with the rim. Smaller: they brake a can or a coin that
/// rolls. Of the thickness, larger: a coin's other rim is taken.
inline constexpr double kRimOfRadius = 0.2;
inline constexpr double kRimOfThickness = 0.4;
/// A surface has an edge where it bends by more than this fraction of the first of kFlatScales.
/// Smaller: round surfaces count as edges. Larger: edges count as faces, whose normals lean.
inline constexpr double kEdgeBend = 0.1;
/// How often the place of a round surface that faces an edge is looked for, each time from the
/// center of curvature of the last one.
inline constexpr int kMostFacing = 4;
/// Sine by which the normals of a round surface and of what it slides over may miss each other on
/// the way, and of a first step along it, how far from an edge it ends. Smaller: places are looked
/// for in vain where cells of a field meet. Larger: planes lean.
inline constexpr double kSlidesWithin = 0.01;

// ---- contacts that turn -------------------------------------------------------------------------
// Decision 61.

/// Radians by which a path bends in a step, below which bodies go straight on: displacements of the
/// smaller body are compared with its radius. Smaller: slower. Larger: bodies that roll slowly in
/// bowls lose speed.
inline constexpr double kLeastTurn = 0.002;
/// Radians by which a body itself turns in a step, below which it comes nearer to flat ground by
/// nothing that matters. Smaller: slower. Larger: ellipsoids that tumble end steps deeper.
inline constexpr double kLeastOwnTurn = 0.02;
/// The cosine of the most radians. Larger cosines: at low rates, bodies lose speed in narrow bends.
/// Smaller: another wall counts as the same one.
inline constexpr double kLeastCosineOfTurn = 0.7;
/// How much of its displacement a body may come nearer to a surface that turns by that: the sine of
/// half the angle.
inline constexpr double kMostTurn = 0.4;
/// Where the normals of round bodies on a concave surface may miss each other by kSlidesWithin, as
/// a fraction of what the place turns by. Larger: what the places miss is as much as the turn is.
inline constexpr double kSlidesWithinOfTurn = 0.1;
/// Deeper in a wall than by this fraction of its thickness, its other side is near. Larger: what
/// turns at the end of a step is not found. Smaller: in close bores, the wall opposite is.
inline constexpr double kDeepInWall = 0.25;
/// A place of a body that spins slides on by at most this at once, radians. Larger: it is not
/// found.
inline constexpr double kMostTurnOfSlide = 0.25;
/// A surface that bends evenly has come nearer by a quarter when half of the step is over. It may
/// be off by this fraction of the whole. Larger: walls ahead are taken for bends, and entered.
inline constexpr double kUnevenTurn = 0.5;
/// Bodies on a path that bends end each step a little off the surface: by at most this fraction of
/// what they come nearer within it. Larger: what lands is taken to have slid before.
inline constexpr double kMostGapOfTurn = 0.5;
/// What closes on the surface by more than this many times what the path comes nearer by is a blow,
/// and rebounds; a body that went straight on in the step before closes by twice as much. Smaller:
/// elastic balls lose speed in bowls.
inline constexpr double kMostClosingOfTurn = 3.0;
/// The places with which two bodies will touch are apart now by at most this multiple of what the
/// bodies move past each other until then. Larger: flat places are far from those that touch, and
/// angular momentum is lost. Smaller: balls that hit each other aslant begin to spin.
inline constexpr double kMostAside = 1.25;
/// Where they do, their normals miss each other by at most this angle, radians. Larger: tori that
/// fall flat on the ground touch it aslant. Smaller: so do balls that hit each other.
inline constexpr double kMostLeanOfTouch = 0.05;
/// By how much a direction is tilted to see how round a surface is, radians.
inline constexpr double kTilt = 0.1;
/// Surfaces touch where they are nearer than this fraction of the pair's finest detail. Smaller:
/// more steps of conservative advancement. Larger: fast bodies stop visibly early.
inline constexpr double kTouchingOfDetail = 0.05;
/// Conservative advancement moves by this fraction of the gap where the field's own lower bound
/// says that it is safe: two voxels and more from the surface, and in every analytic field. Larger:
/// the bound refuses it more often. Smaller: more steps.
inline constexpr double kBoldOfGap = 0.9;
/// The same without asking: one over the square root of three. A field's values are means of
/// distances at nodes, and no two nodes differ by more than they are apart; so along each axis it
/// is no steeper than 1. Larger: fast bodies may pass thin walls. Decision 14.
inline constexpr double kSafeOfGap = 0.577;
/// Most steps of one advancement; where they are not enough, there is a contact with the gap that
/// is left. Smaller: bodies that graze a surface are kept away from it.
inline constexpr int kMostAdvances = 128;
/// A place of an edge is the one nearest to the other body where the field's normal leans along the
/// edge by at most this sine. Smaller: edges that lie flat have their contacts moved to and fro.
inline constexpr double kNearestWithinSine = 1e-3;
/// The same where nothing rebounds. Smaller: what slides over flush faces is braked. Larger: what
/// tips over an edge is turned too fast by the face beside the edge.
inline constexpr double kLeaningSine = 0.02;
/// An edge crosses another one where the mean of the normals beside it, weighted to be square to
/// it, is at least this long. Smaller: walls on two sides count as one edge, and the depth between
/// them, divided by that length, has no bound. Larger: sharp edges do not cross.
inline constexpr double kLeastCrossing = 0.5;
/// What touches comes first of its own surface in that direction, within 3 degrees. Smaller: what
/// lands flush touches with fewer places. Larger: faces that tip over an edge stay on it.
inline constexpr double kForemostAngle = 0.05;
inline constexpr double kForemostCosine = 1.0 - 0.5 * kForemostAngle * kForemostAngle;
/// Only where bodies close by less than this fraction of the thinner one's thickness within the
/// step: the touch turns them by little then. Larger: what is thrown down lands deeper, with what
/// came later before the touch. Smaller: at low rates, faces stay on the edge that they tip over.
inline constexpr double kGentleOfThickness = 0.3;
/// What comes first there is looked up this fraction of the rest margin outside. Larger: other
/// parts of the body are nearer. Smaller: rounding decides.
inline constexpr double kOutsideOfMargin = 0.25;
/// The place where two edges cross is looked for from this fraction of the displacement on, up to
/// this many times the displacement from where it was, and then by this many halvings. More: edges
/// that are nearly parallel have no one place where they cross.
inline constexpr double kFirstSlideOfWay = 0.25;
inline constexpr double kMostSlideOfWay = 4.0;
inline constexpr int kSlideHalvings = 16;
/// Features inside a model have left it where they are at most this deep, in voxels.
inline constexpr double kLeftOfVoxel = 1e-3;
/// Triangles farther from the model than this many touching gaps where the model first touches
/// count as planes. Decision 13.
inline constexpr float kPlaneBeyondGaps = 2.0f;

// ---- rebound ------------------------------------------------------------------------------------

/// Contacts that touch within this fraction of the step after the first one rebound with it.
/// Larger: ten iterations of the solver leave a body that lands on several points with too much
/// energy. 0: only one of the points of a flat landing rebounds.
inline constexpr double kFirstTouchWithin = 0.05;
/// Those within this fraction do so whatever the first one leaves of their approach. Larger: what
/// lands on a corner and is turned away rebounds beside it, too, and tilts. Smaller: by rounding,
/// not all points of a flat landing rebound.
inline constexpr double kTogetherWithin = 1e-3;
/// A contact that touches later rebounds as well, if the rebounds of earlier ones change its
/// approach by at most this fraction; others only stop approaching. Larger: contacts that are not
/// reached any more rebound. 0: a body that lies in a tray does not rebound from its walls.
inline constexpr double kFreeOfApproach = 0.05;
/// Normals of contacts at right angles have at most this cosine of the angle between them. 0.5: a
/// dropped stack of elastic cubes gains three times as much energy.
inline constexpr float kMostCosineOfWalls = 0.1f;
/// How often the contacts that touch are gone through for what they leave of the fall. Fewer: what
/// slides in a groove is thought to fall into its walls.
inline constexpr int kGuidedSweeps = 4;
/// They guide a fall if they take more than this fraction of it, and leave more than that. 0: what
/// guides a body that something else supports lets it fall, too. Larger: gentle and
/// steep ramps brake what slides down them.
inline constexpr double kLeastGuided = 0.05;
/// How often the contacts that touch first are gone through for what they leave of the motion.
/// Fewer: what touches later at the other side of a body that lands flat is thought to leave.
inline constexpr int kReboundSweeps = 8;
/// The fraction of the last step's impulses that Bullet's solver starts from: the default of
/// btContactSolverInfo::m_warmstartingFactor. Another value there than here: still bodies rock.
inline constexpr double kWarmStartingFactor = 0.85;

// ---- rest ---------------------------------------------------------------------------------------

/// A pair is still if its kinetic energy could lift it by at most this fraction of the rest margin.
/// Larger: a ball that rolls slowly is stopped. Smaller: bodies on rounded bellies rock for longer.
inline constexpr double kStillOfMargin = 0.15;
/// A body is supported if its contacts took from it, in the last step, what forces gave it, up to
/// this fraction of that. Larger: a body that a blow has stopped is taken to be supported by it.
/// Smaller: what the solver leaves of a stack's motion makes its bodies fall.
inline constexpr double kSupportedWithin = 0.1;
/// Where a light body lies between heavy ones, the solver may leave this fraction of what they
/// press it with. Larger: bodies below ten times their weight use CCD at low rates, and take
/// longer. Smaller: bricks below a thousand times theirs move by half a millimeter at 30 Hz.
inline constexpr double kUnsolvedOfLoad = 1e-3;
/// Contacts are not searched for again while the pair, and what it moves by in a step, have changed
/// by at most this fraction of the rest margin. Half of kIdleOfMargin: what was left out is not
/// deeper by then than what was the deepest. 0: stacks that tremble by nanometers are searched in
/// every step; 0.01: heaps that creep are, in every other one. Decision 47.
inline constexpr double kKeptOfMargin = 0.1;
/// The same where contacts are not followed, as those of features of Bullet's shapes.
inline constexpr double kKeptUnfollowedOfMargin = 0.01;
/// Kept contacts of round surfaces follow them once the pair has moved by this fraction of the rest
/// margin. Larger: a ball that hardly rolls is pushed on by the contact that it leaves behind, and
/// a shaft in a seat begins to rock. Smaller: more slides.
inline constexpr double kFollowedOfMargin = 0.002;
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
inline constexpr float kKeepsPointsOfMargin = 0.25f;
/// A manifold with as many points as this need not look for more.
inline constexpr std::size_t kSupportingPoints = 3;
/// Contacts of a still body are of at most this many flat patches, or are left as they are.
inline constexpr std::size_t kMostPatches = 8;
/// Contacts whose normals lean by up to eight degrees are on the rim of a patch that has this many
/// times as many, and get its normal. Larger: bodies without friction are pushed aside.
inline constexpr std::size_t kRimOfPatch = 8;
/// Normals within this sine of each other are those of one patch. Larger: the outermost points of a
/// uniform model, whose edges are rounded, push aside.
inline constexpr float kSamePatch = 1e-4f;
/// Patches shrink by at most this fraction of half their width when points that do not span them
/// are left out. Smaller: rims have more points. Larger: cans tip early.
inline constexpr double kPatchShrink = 0.01;
/// Or by this fraction of the smaller body's radius. Smaller: of a row, points in the middle stay,
/// which change from step to step. Larger: beams on narrow feet tip early.
inline constexpr double kLeastPatchShrinkOfRadius = 1e-4;
/// Points are in a patch if they are deeper than the plane of those that span it by at most this
/// fraction of the rest margin. Larger: bodies are carried beside their deepest point.
inline constexpr float kFlatOfMargin = 0.02f;
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
/// It does if the shell's own surface is nearer than this fraction to a place in front of it: one
/// spacing for points.
inline constexpr float kFreeInFront = 0.3f;
/// The same for edges, which are sharp, as a fraction of the smaller body's radius. Larger: teeth
/// and threads count as beside their neighbors.
inline constexpr double kEdgeReachOfRadius = 0.02;

/// Radians that a part of a surface may be turned away from the other body, beside what the pair
/// can turn within the step. Smaller: bodies that land on a face are stopped at its edges alone.
/// Larger: the sides of a coin that rolls upright brake it.
inline constexpr double kSteep = 0.5;

// ---- features of Bullet's shapes ----------------------------------------------------------------

/// A rim whose plane and the model's surface are within this sine of each other lies flat: it has
/// no deepest point. Larger: the deepest point of a tilted rim is missed.
inline constexpr double kFlatRim = 0.1;
/// Far from the surface a grid's distances are rough: a ball is looked for this fraction of its
/// radius farther away. Smaller: large balls are missed. Larger: slower.
inline constexpr double kBallSlack = 0.5;
/// Corners that touch something look along their way from as far above it, of the height of their
/// shape's middle. Smaller: the way stops at what rises a little. Larger: they meet walls too high,
/// and tip.
inline constexpr double kLiftOfMiddle = 0.25;
/// Most steps along a ball's surface to the place that is deepest in the model. Each at least
/// halves the error on smooth surfaces.
inline constexpr int kBallSteps = 8;
/// Contacts of a ball have the id of the first direction whose cosine with theirs is less than that
/// of the nearest by at most this. 0: where a groove lies between two directions, ids change with
/// each rounding.
inline constexpr double kNearlyAsNear = 0.02;
/// Where a field's gradient is shorter than this, walls on two sides of a place are as near.
/// Larger: so are single ones of coarse grids.
inline constexpr double kOneWall = 0.95;
/// The ball that ends a capsule is its surface from this sine behind the ball's equator on. 0: by
/// rounding, a capsule that lies on its side touches nothing.
inline constexpr double kCapRim = 0.01;
/// A feature inside a model leaves it by the line to its shape's middle, up to this many times the
/// way there: the shape's other end.
inline constexpr double kToOtherEnd = 2.0;

// ---- Bullet's triangles -------------------------------------------------------------------------
// Decision 13.

/// Samples of triangles are at most this fraction of a model's longest side apart, or a voxel.
/// Smaller: what is between them is found more surely, more slowly.
inline constexpr double kSampleOfSize = 1.0 / 32.0;
/// The same of the field's lower bound where that is more: far away coarser samples will do.
inline constexpr float kSampleOfBound = 0.5f;
/// Most cells along a model's longest side, with a contact each.
inline constexpr int kMostCellsAlongSide = 16;
/// A piece whose longest edge is twice its shortest, so that their squares have this ratio, is
/// halved, not quartered: thin slivers would stay thin.
inline constexpr float kSlenderSquared = 4.0f;
/// How often a triangle may be split; more than any finite triangle needs.
inline constexpr int kMostSplits = 64;
/// How often the best piece of a cell is quartered to find its deepest place: to a 32nd of it.
inline constexpr int kQuarterings = 5;
/// A place is on an edge of its triangle if it is nearer to it than this, relative to the
/// triangle's size: there the field's normal counts.
inline constexpr float kOnEdge = 1e-4f;
/// Inside a triangle its own normal counts where its cosine with the field's is at least this.
/// Larger: kinks that edges make in the field give a contact the normal of a face beside it.
inline constexpr float kMostKink = 0.5f;

// ---- flat elements ------------------------------------------------------------------------------

/// Normals of surfaces that touch have at most this cosine; others are looked at: within a quarter
/// of a degree. Larger angles: a ball that drops straight on a flat ground leaves sideways.
inline constexpr float kAlignedCosine = -0.99999f;
/// Distances at which the bends of two surfaces are compared, as fractions of the smaller body's
/// radius. The first one spans the facets that stand for a curved surface.
inline constexpr std::array kFlatScales{0.1, 0.3, 1.0};
/// A surface is flat at a distance if it is no farther from its tangent plane than this fraction of
/// that distance. A ball bends by a 20th at the first scale.
inline constexpr double kFlatBend = 0.01;
/// Depths along a normal are found to this fraction of the rest margin.
inline constexpr double kDepthPrecision = 0.01;
/// They are looked for up to this many rest margins inside.
inline constexpr double kDeepestColumn = 100.0;
/// Of a speculative contact they are looked for up to this many touching gaps.
inline constexpr double kColumnGaps = 4.0;
/// A depth along an element's normal counts if the shell's own surface is at least this fraction of
/// it away where it ends: else another face of the shell is nearer there.
inline constexpr double kOwnDepth = 0.5;
/// The least slope, as a cosine, by which the rest of a depth is divided.
inline constexpr double kLeastSlope = 0.1;

/// Most poses on the way of a step at which a shell is looked up in the field, as far apart as the
/// detail of the finer body where these are enough. Fewer: slots and rims pass what they fall on.
inline constexpr int kMostSweptPoses = 8;

// ---- round contacts -----------------------------------------------------------------------------
// Decision 36.

/// Contacts that slide to places nearer to each other than this fraction of the smaller body's
/// radius are one. Larger: a body that rests on two such places rocks.
inline constexpr double kSameOfRadius = 0.01;
/// A contact that has moved by at most this fraction of the smaller body's radius in a step is the
/// same one. Smaller: impulses are lost and found again as bodies roll.
inline constexpr double kFollowedOfRadius = 0.1;
/// What slid to nothing is not slid again until the bodies have moved by this fraction of the
/// smaller body's radius. Larger: bodies that creep feel samples.
inline constexpr double kFailsAgainOfRadius = 0.001;
/// How much farther than its depth a contact may be from the place of a round surface that it is
/// said to be nearest to: far from surfaces, grids' distances are rough.
inline constexpr double kNearestWithin = 1.25;
/// Radians by which the two normals at the end of a slide may miss each other. Smaller: normals of
/// a grid are not that smooth. Larger: a ball rolls with torques of its own.
inline constexpr double kSlideWithin = 1e-3;
/// The same where both surfaces are smooth: a shaft that spins in a bearing lost 4 % a second.
inline constexpr double kSmoothSlideWithin = 1e-4;
/// The same of contacts that follow a round surface, if they can be found so precisely. Larger:
/// they stay behind, the more the better the two surfaces fit, and bodies in round seats begin to
/// rock.
inline constexpr double kFollowedWithin = 1e-6;
/// A place is nearest to the inside of a smooth surface, not to its end, where it is aside of that
/// normal by at most this fraction of its distance. Larger: what is beyond an edge feels the face
/// that ends there.
inline constexpr double kAsideOfDistance = 0.1;
/// A field is smooth up to a depth of this many times what smoothing moves its surface by. Smaller:
/// what sinks in for a step feels facets. Larger: at the middle of a wall, where the two sides are
/// as near, contacts take one of them.
inline constexpr double kSmoothOfLift = 10.0;
/// Far from a model, where the cells of its field are large, distances are off by up to this
/// fraction of them. Smaller: smooth surfaces are looked for in vain. Larger: another place that is
/// nearly as near is taken for the nearest.
inline constexpr double kFarFieldError = 0.05;
/// Surfaces that follow each other, as a peg and its hole do, have no one deepest place: the
/// field's normal turns by more than this fraction of what a slide was to turn by. Smaller: a ball
/// in a bowl feels its samples. Larger: slides along such surfaces lead far.
inline constexpr double kFollowsOfTurn = 0.75;
/// The same where both surfaces are smooth: a shaft in a bearing that is a tenth wider rolls in it.
inline constexpr double kFollowsOfSmoothTurn = 0.97;
/// Places that may come before a contact, once the body has turned, by at most this fraction of the
/// smaller body's radius are none of its own. Smaller: facets of a ball that turns by half a radian
/// in a step brake it. Larger: the body is deeper in the other for a step.
inline constexpr double kLeadOfRadius = 0.005;
/// Where a straight surface leans by less than this sine against a round one, it is where they face
/// each other.
inline constexpr double kStraightLean = 2e-3;
/// On the way to where they face each other, it turns by at most this fraction of that lean.
/// Larger: balls are straight where their patches meet, and touch with samples there.
inline constexpr double kStraightTurn = 0.25;
/// A place under an edge is found to this fraction of the distance within which places are one.
inline constexpr double kEdgeWithin = 0.1;
/// Samples slide to an edge that is no farther away than this fraction of their spacing. Larger:
/// where two straight surfaces touch along a line, all samples slide to its deeper end, and the
/// other end of the body falls into what it lands on.
inline constexpr double kEdgeOfSpacing = 0.5;
/// Most ways along a straight surface in turn.
inline constexpr int kMostStraight = 4;
/// Most slides of a contact in turn, each toward the field's normal where the last one ended.
inline constexpr int kMostSlides = 8;
/// A slide that leads out of the field by more than this fraction of the rest margin is none: the
/// field's surface bends away.
inline constexpr double kSlideLosesOfMargin = 0.1;
/// Where an edge touches a round surface, the cosine of their angle is below this. Larger: the
/// place jumps from one piece of the edge to the next.
inline constexpr double kZeroWithin = 1e-4;
/// Most steps along an edge to that place.
inline constexpr int kMostZeroSteps = 24;
/// Of these, most over which the normal does not turn, each twice as long as the last, before there
/// is no such place: from a hundredth of the smaller body's radius to a third.
inline constexpr int kMostFlatSteps = 5;
/// A normal beside an edge is that of a face of it where its cosine with the edge is below this.
inline constexpr double kFaceOfEdge = 0.1;
/// An edge touches where no face beside it leads toward the round body by more than this sine.
/// 0: by rounding, a cylinder that lies across a bar touches neither edge of it. Larger: what rolls
/// toward an edge is braked by it.
inline constexpr double kLeansOverFace = 5e-3;

// ---- facing normals -----------------------------------------------------------------------------

/// Normals of surfaces that touch have at most this cosine: within eight degrees.
inline constexpr float kFacingCosine = -0.99f;
/// Contacts outside by more than this many reaches lie beside the field's body, not along its rim.
inline constexpr double kFacingOutside = 0.1;
/// Contacts deeper than this many reaches keep their normals.
inline constexpr double kFacingInside = 8.0;
/// How often the reach is doubled to get out of the field: up to kFacingInside.
inline constexpr int kFacingDoublings = 3;

// ---- ways out -----------------------------------------------------------------------------------
// Decision 38.

/// A contact pushes aside, neither against its element nor from behind it, where the cosine of
/// their normals is within this of 0: three degrees. Smaller: rounding decides. Larger: sharp
/// needles have no contacts.
inline constexpr float kAside = 0.05f;
/// Bodies that are deeper in each other than this many default rest margins, and have no contact
/// that deep, leave by the shortest way. Smaller: contacts of rims would do. Larger: thin plates
/// stay in each other.
inline constexpr double kDeepOfMargin = 8.0;
/// Ways out are found to this fraction of that depth.
inline constexpr double kWayOutPrecision = 0.125;
/// From one distance that is tried to the next. Larger: ways that are not the shortest.
inline constexpr double kWayOutGrowth = 1.25;
/// Directions with a larger cosine are one: within three degrees.
inline constexpr double kSameWayOut = 0.9986;
/// The deepest place of a shape's core segment is found to this fraction of it. Larger: sheets that
/// are thinner than that, pierced at a slant, are missed.
inline constexpr double kCorePrecision = 1e-4;

// ---- both shells --------------------------------------------------------------------------------

/// A contact of the second shell is a double if its normal and that of one of the first have at
/// least this cosine: within ten degrees. Decision 26.
inline constexpr float kDoubleCosine = 0.985f;
/// How far along a direction those within a distance are looked for, relative to it.
inline constexpr float kSortedReach = 1.01f;

// ---- seams --------------------------------------------------------------------------------------
// Decision 35.

/// How far around a contact surfaces are looked for, as a fraction of the smallest body's radius.
/// Smaller: narrow gaps between tiles act. Larger: wider gaps and gentle ramps do not.
inline constexpr double kSeamReach = 0.01;
/// Surfaces that differ by less in height are flush: the same fraction, one and a half rest
/// margins. Smaller: bodies that float within the margin stop. Larger: visible steps do not act.
inline constexpr double kSeamStep = 0.003;
/// How often the normal of the surface beside is looked for: first near an edge, then over a face.
inline constexpr int kSeamTurns = 2;
/// How often a place is lowered by its distance from the surface that carries it: on slopes, once
/// is not enough.
inline constexpr int kSeamDrops = 3;
/// Normals that differ by this sine are those of two walls, which meet in the corner of a channel.
/// Smaller: those of curved surfaces are. Larger: bodies stop at seams of obtuse channels.
inline constexpr double kSeamWall = 0.3;
/// A place counts as over a face if it is beside its edge by no more than this fraction of a step.
/// 0: where a body's edge lies along a seam, neither tile is beside it. Larger: normals of edges.
inline constexpr double kSeamBeside = 0.1;
/// Behind a seam the surface has the plane's normal, to this cosine: 26 degrees. Smaller: where two
/// flush bodies carry a third by their corners, those contacts are lost.
inline constexpr double kSeamFlush = 0.9;
/// Contacts of a body without seams are not examined again while it and what it touches have moved
/// by at most this fraction of the smallest one's radius, a hundredth of the reach. 0: bodies in a
/// heap, which tremble, are examined in every step. Larger: steps at seams are noticed late.
inline constexpr double kSeamKeptOfRadius = 1e-4;
/// How often a contact is compared with all bodies beside it: two seams cross where four meet.
inline constexpr int kSeamRounds = 2;
/// On either side, behind the plane that parts two bodies, the one that it carries has nothing
/// within this fraction of the reach. Larger: bodies that tilt a little are not parted.
inline constexpr double kPartedOfReach = 0.5;
/// In front of it, the other one has nothing within this fraction. Smaller: gentle ramps that begin
/// at the plane act no longer. Larger: nor do holes that a body tilts in by less than two degrees.
inline constexpr double kRoomOfReach = 0.97;
/// One of them has a face there with the plane's normal, to this cosine: 8 degrees. Smaller: planes
/// through edges part flush bodies, and turn contacts of their faces.
inline constexpr double kPartingFace = 0.99;
/// Behind a rim, its face is looked for that many reaches away. Smaller: over the rim itself.
/// Larger: narrow faces are missed.
inline constexpr double kBehindRimOfReach = 2.0;
/// A contact whose normal has at least this cosine with a plane's keeps it: one degree. Smaller:
/// edges that cross turn what glides over them. Larger: what tilts a little creeps: from a fifth of
/// a degree on, a mug in a gripper at 30 Hz.
inline constexpr double kOwnOfPlane = 0.99985;
/// A face of a shape of Bullet's is flat if its normal is the same, to this cosine, that many
/// reaches away: half a degree. Smaller: the planes of round surfaces part bodies, which then slip
/// through.
inline constexpr double kFlatFace = 0.99995;
inline constexpr double kFaceOfReach = 4.0;
/// Normals with at least this cosine are those of one plane.
inline constexpr double kSeamAligned = 0.999999;
/// A contact that leans by more than 120 degrees pushes into the surface beside it.
inline constexpr double kSeamOpposed = 0.5;
/// Contacts that lean by up to 45 degrees carry the body, and are turned; others are removed.
inline constexpr double kTurnedCosine = 0.70710678118654752;

// ---- checked motion -----------------------------------------------------------------------------
// Decision 63.

/// Bodies are checked that the solver moves farther than expected by more than this fraction of
/// their size. Smaller: bodies in heaps are. Larger: what it makes fast enters walls by that much.
inline constexpr double kCheckedOfSize = 0.01;
/// And farther by this fraction of what was expected, as guards look about as far again.
inline constexpr double kCheckedOfExpected = 0.5;
/// Bodies that have parted come back by more than this fraction of the smaller one's size. Smaller:
/// steps are solved again for rounding. Larger: corners of what rebounds end the step as deep.
inline constexpr double kReturnedOfSize = 0.0005;
/// Pairs of models that have contacts are searched for others where they come to be in each other
/// by this fraction of kCheckedOfSize. Larger: places that pass a contact aslant are missed.
inline constexpr double kDeepOfChecked = 0.5;
/// Most poses on the way at which these are looked up, kDetailOfThickness of the thinner body
/// apart. More take as long as the search.
inline constexpr int kMostPosesOnTheWay = 32;
/// How often a step is solved at most. Fewer: at low rates a blow passes through fewer balls of a
/// row within a step, and they end in each other. Larger: heaps of elastic bodies take longer.
inline constexpr int kMostSolutions = 9;
/// Bodies that a blow has parted may come back, in the solution after it, up to this many times as
/// fast: a light ball between two heavy ones that approach it comes back five times as fast. Below
/// 1: what holds them adds energy. Larger: after the last solution, they are deeper in each other.
inline constexpr double kReturnOfParting = 5.0;

// ---- bodies that turn into each other -----------------------------------------------------------
// Decision 66.

/// Bodies that turn may end a step in each other by this fraction of the smaller one's size.
/// Smaller: more steps are solved twice.
inline constexpr double kEndOfSize = 0.001;
/// Bodies that turn by more, radians, are left: where the step ends says nothing of how they got
/// there. Larger: needles that spin about their axis fall through slabs at 30 Hz.
inline constexpr double kMostAngleOfEnd = 1.5;
/// Turning moves a place that touches along its normal by at least this fraction of the depth.
/// Smaller: wheels that roll over waves are braked.
inline constexpr double kLeastByTurning = 0.5;
/// A body is round if its depth changes by less than this fraction of half the smaller body's
/// shortest side, from a tenth to a half of the depth, where it does not turn or turns by half.
/// Smaller: what has facets is braked where it rolls over waves or in a half-pipe. Larger: eggs and
/// boxes land deeper.
inline constexpr double kSameOfThickness = 0.002;
inline constexpr double kLeastSameOfDepth = 0.1;
inline constexpr double kMostSameOfDepth = 0.5;
/// How often a step is solved at most for bodies that turn. Fewer: capsules that a blow turns are
/// deeper.
inline constexpr int kMostSolutionsOfTurns = 3;

// ---- Bullet's round shapes on planes ------------------------------------------------------------

/// The lowest places of one of Bullet's shapes on a plane are looked for as if it were turned by
/// this, radians: corners of faces that lie flat to rounding.
inline constexpr double kTurnOfFlat = 1e-3;
/// And by this: corners of faces that land aslant. Larger: more corners that are too high to touch.
inline constexpr double kTurnOfLanding = 0.3;

// ---- segments -----------------------------------------------------------------------------------

/// Level of the segments, up to 64.
inline constexpr int kDefaultLevel = 4;
/// The same in steps with CCD: a body that turns while it is stopped is held by more points.
inline constexpr int kDefaultCcdLevel = 5;

}  // namespace voxshell::bullet

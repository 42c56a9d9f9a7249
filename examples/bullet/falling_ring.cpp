// A ring falls onto a ball on a table: a plain Bullet program but for the lines marked
// "voxshell".
#include <cmath>
#include <cstdio>
#include <vector>

#include <btBulletDynamicsCommon.h>

#include <voxshell/bullet/collision_configuration.h>
#include <voxshell/bullet/coulomb_solver.h>
#include <voxshell/bullet/model_shape.h>

static voxshell::TriangleMesh make_ring(double radius, double thickness) {
  constexpr unsigned kAround = 64, kAcross = 24;
  std::vector<voxshell::Vec3> vertices;
  std::vector<voxshell::Triangle> triangles;
  for (unsigned i = 0; i < kAround; ++i) {
    for (unsigned j = 0; j < kAcross; ++j) {
      const double u = 2 * M_PI * i / kAround, v = 2 * M_PI * j / kAcross;
      const double r = radius + thickness * std::cos(v);
      vertices.push_back({r * std::cos(u), r * std::sin(u), thickness * std::sin(v)});
      const unsigned a = i * kAcross + j, b = i * kAcross + (j + 1) % kAcross;
      const unsigned c = (a + kAcross) % (kAround * kAcross),
                     d = (b + kAcross) % (kAround * kAcross);
      triangles.push_back({a, c, b});
      triangles.push_back({b, c, d});
    }
  }
  return *voxshell::TriangleMesh::create(vertices, triangles);
}

int main() {
  voxshell::bullet::CollisionConfiguration configuration;  // voxshell, for btDefaultCollision...
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  voxshell::bullet::CoulombSolver solver;  // voxshell, for btSequentialImpulseConstraintSolver
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.setGravity(btVector3(0, 0, -9.81));
  world.getSolverInfo().m_splitImpulsePenetrationThreshold = 0;  // rebounds as the restitution says

  const auto model = voxshell::Model::build(make_ring(0.1, 0.03), {.tolerance = 0.0001});
  if (!model) return std::puts(model.error().message.c_str()), 1;
  voxshell::bullet::ModelShape ring(*model);  // voxshell, as any other shape
  btBoxShape table(btVector3(1, 1, 0.1));
  btSphereShape ball(0.06);
  btVector3 inertia;
  ring.calculateLocalInertia(1, inertia);
  btRigidBody table_body(0, nullptr, &table), ball_body(0, nullptr, &ball);
  btRigidBody ring_body(1, nullptr, &ring, inertia);
  table_body.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 0, -0.1)));
  ball_body.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 0, 0.06)));
  ring_body.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0.01, 0, 0.5)));
  for (btRigidBody* body : {&table_body, &ball_body, &ring_body}) world.addRigidBody(body);

  for (int i = 0; i < 600; ++i) world.stepSimulation(1.0 / 200, 0);
  const double height = static_cast<double>(ring_body.getWorldTransform().getOrigin().z());
  std::printf("the ring lies around the ball, %.1f mm above the table\n", 1e3 * height);
  for (btRigidBody* body : {&table_body, &ball_body, &ring_body}) world.removeRigidBody(body);
  return std::abs(height - 0.03) < 0.001 ? 0 : 1;
}

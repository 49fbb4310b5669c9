// A scene run by Simbody: `simbody_run < SCENE > TRACK.json`.
//
// Reads numbers: gravity, span, samples, patience, accuracy, modulus, transition speed; the surfaces of the ground;
// the moving bodies (mass, inertia, pose, velocities) with their surfaces. A surface is its kind (0 half space, 1 sphere,
// 2 ellipsoid), semi-axes, position, quaternion and friction. Writes {rows, seconds}.
#include <Simbody.h>
#include <cstdio>
#include <ctime>
#include <iostream>

using namespace SimTK;

static double number() {
  double value = 0;
  std::cin >> value;
  return value;
}

static Vec3 vector() {
  const double x = number(), y = number(), z = number();
  return Vec3(x, y, z);
}

static Transform pose() {
  const Vec3 p = vector();
  const double w = number(), x = number(), y = number(), z = number();
  return Transform(Rotation(Quaternion(w, x, y, z)), p);
}

static void addSurfaces(Body &body, double modulus) {
  for (int left = (int)number(); left > 0; left--) {
    const int kind = (int)number();
    const Vec3 axes = vector();
    Transform place = pose();
    const double slide = number();
    const ContactMaterial material(modulus, 0, slide, slide);
    if (kind == 0) { // a half space fills x > 0
      place = Transform(place.R() * Rotation(Pi / 2, YAxis), place.p());
      body.addContactSurface(place, ContactSurface(ContactGeometry::HalfSpace(), material));
    } else if (kind == 1) {
      body.addContactSurface(place, ContactSurface(ContactGeometry::Sphere(axes[0]), material));
    } else {
      body.addContactSurface(place, ContactSurface(ContactGeometry::Ellipsoid(axes), material));
    }
  }
}

int main() {
  MultibodySystem system;
  SimbodyMatterSubsystem matter(system);
  GeneralForceSubsystem forces(system);
  ContactTrackerSubsystem tracker(system);
  CompliantContactSubsystem contacts(system, tracker);
  Force::UniformGravity gravity(forces, matter, vector());
  const double until = number();
  const int samples = (int)number();
  const double patience = number(), accuracy = number(), modulus = number();
  contacts.setTransitionVelocity(number());
  addSurfaces(matter.updGround().updBody(), modulus);
  const int n = (int)number();
  std::vector<MobilizedBody::Free> bodies;
  std::vector<Transform> places;
  std::vector<SpatialVec> speeds;
  for (int k = 0; k < n; k++) {
    const double mass = number();
    const Vec3 moments = vector(), products = vector();
    Body::Rigid body(MassProperties(mass, Vec3(0), Inertia(moments, products)));
    places.push_back(pose());
    const Vec3 v = vector(), w = vector();
    speeds.push_back(SpatialVec(w, v));
    addSurfaces(body, modulus);
    bodies.push_back(MobilizedBody::Free(matter.Ground(), Transform(), body, Transform()));
  }
  State state = system.realizeTopology();
  for (int k = 0; k < n; k++) bodies[k].setQToFitTransform(state, places[k]), bodies[k].setUToFitVelocity(state, speeds[k]);
  RungeKuttaMersonIntegrator integrator(system);
  integrator.setAccuracy(accuracy);
  TimeStepper stepper(system, integrator);
  stepper.initialize(state);
  const std::clock_t begun = std::clock();
  double seconds = 0;
  std::printf("{\"rows\": [");
  for (int sample = 0; sample <= samples && seconds <= patience; sample++) {
    if (sample) stepper.stepTo(until * sample / samples);
    const State &now = integrator.getState();
    system.realize(now, Stage::Velocity);
    std::printf("%s[", sample ? ", " : "");
    for (int k = 0; k < n; k++) {
      const Transform at = bodies[k].getBodyTransform(now);
      const Quaternion turn = at.R().convertRotationToQuaternion();
      const Vec3 v = bodies[k].getBodyOriginVelocity(now);
      std::printf("%s[%.17g, %.17g, %.17g, %.17g, %.17g, %.17g, %.17g, %.17g, %.17g, %.17g]", k ? ", " : "", at.p()[0],
                  at.p()[1], at.p()[2], turn[0], turn[1], turn[2], turn[3], v[0], v[1], v[2]);
    }
    std::printf("]");
    seconds = (double)(std::clock() - begun) / CLOCKS_PER_SEC;
  }
  std::printf("], \"seconds\": %.9g}\n", seconds);
  return 0;
}

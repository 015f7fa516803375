"""Find the pose of a scanner from planes seen twice: GTSAM's OrientedPlane3 factors with our covariances."""

import gtsam
import numpy as np

import scanseg

# the same office from where the first scan was taken, and turned and shifted afterwards
office = scanseg.office(3, noise_m=0.005)
truth = gtsam.Pose3(gtsam.Rot3.RzRyRx(0.01, -0.02, 0.03), np.array([0.05, -0.03, 0.02]))
first = scanseg.segment(office.ranges, office.beams, noise=0.005).segments
planes = first[(first["planarity"] == "planar") & (first["pixels"] > 300)]

graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
POSE = gtsam.symbol("x", 0), gtsam.symbol("x", 1)
graph.add(gtsam.PriorFactorPose3(POSE[0], gtsam.Pose3(), gtsam.noiseModel.Isotropic.Sigma(6, 1e-6)))
for pose in POSE:
    values.insert(pose, gtsam.Pose3())

rng = np.random.default_rng(7)
for i, plane in enumerate(planes):
    landmark = gtsam.symbol("p", i)
    # GTSAM's planes are normal @ p == d, ours normal @ p + distance == 0
    seen = gtsam.OrientedPlane3(*map(float, plane["normal"]), -float(plane["distance_m"]))
    values.insert(landmark, seen)
    for pose, at in zip(POSE, [gtsam.Pose3(), truth]):
        here = seen.transform(at)
        # from (normal, distance) to GTSAM's two tangents of the normal and the distance
        basis = here.normal().basis()
        to_tangent = np.block([[basis.T, np.zeros((2, 1))], [np.zeros((1, 3)), -np.ones((1, 1))]])
        covariance = to_tangent @ plane["covariance"].astype(float) @ to_tangent.T
        error = rng.multivariate_normal(np.zeros(3), covariance)
        noise = gtsam.noiseModel.Gaussian.Covariance(covariance)
        graph.add(gtsam.OrientedPlane3Factor(here.retract(error).planeCoefficients(), noise, pose, landmark))

found = gtsam.LevenbergMarquardtOptimizer(graph, values).optimize().atPose3(POSE[1])
error = truth.between(found)
turned, moved = np.degrees(np.linalg.norm(gtsam.Rot3.Logmap(error.rotation()))), np.linalg.norm(error.translation())
print(f"{len(planes)} planes: the pose is found to {turned:.3f} deg and {1000 * moved:.1f} mm")
assert turned < 0.1 and moved < 0.005

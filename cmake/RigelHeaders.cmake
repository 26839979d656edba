# The headers that are installed: the public ones, which docs/api.md lists, and those that they include.
# test/architecture.py holds the two against each other.
set(RIGEL_HEADERS
  core/alignment.h core/body_axes.h core/camera.h core/eigen_types.h core/frame_pair.h core/match.h core/match_columns.h core/pixel_unit.h
  core/pose.h core/prior.h core/rays.h core/rig.h core/stop.h
  minimal/catalogue.h minimal/ransac/ransac_options.h minimal/solvers/prepared_matches.h minimal/solvers/solutions.h
  problems/io/match_file.h problems/io/trajectory_file.h problems/io/version.h problems/scenes/synthetic.h
  problems/trajectories/g2o_file.h problems/trajectories/trajectory.h
  refine/between_factor.h refine/epipolar_cost.h refine/estimate_motion.h refine/least_squares/least_squares.h
  refine/refine.h refine/rig_doubts.h refine/search/doubt.h)

# What prints the inliers of RANSAC runs, and the scene of its pairs. Built by test/arm64.sh for another processor, and
# with the tests for this one, so that a source that is missing here is found. `root` is the source directory.
# The scene needs nothing but core.
add_library(scene STATIC ${root}/problems/scenes/image_noise.cc ${root}/problems/scenes/moving_car.cc
                         ${root}/problems/scenes/scene_matches.cc ${root}/problems/scenes/scene_rig.cc
                         ${root}/problems/scenes/synthetic.cc)
target_link_libraries(scene PUBLIC rigel::minimal)

add_executable(ransac_inliers ${root}/test/arm64/ransac_inliers.cc)
target_link_libraries(ransac_inliers PRIVATE scene)

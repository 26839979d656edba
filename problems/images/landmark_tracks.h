// Landmarks: which key points of several images are one point of the world.
#ifndef RIGEL_PROBLEMS_IMAGES_LANDMARK_TRACKS_H_
#define RIGEL_PROBLEMS_IMAGES_LANDMARK_TRACKS_H_

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "rigel/core/frame_pair.h"
#include "rigel/core/match.h"
#include "rigel/problems/io/track_file.h"

namespace rigel {

// Joins key points that match. A track has at most one point in an image: what would give it a
// second one is refused, so that the better matches should be joined first.
class TrackBuilder {
 public:
  // The number of a key point, the same for the same pixel of an image, as long as its frame is not
  // forgotten.
  int Point(int frame, int camera, const Pixel& pixel);

  // Whether the two points are now of one track.
  bool Join(int a, int b);

  // The track of a point: the number of its least point.
  int Track(int point) const;

  // No further Point() will name this frame.
  void Forget(int frame) { known_.erase(frame); }

  // All points of tracks of at least two of them, by track and then by frame and camera; landmarks
  // count from 0.
  std::vector<Observation> Observations() const;

 private:
  struct Place {
    int frame, camera;
    Pixel pixel;
  };
  bool Before(int a, int b) const;  // frame and camera of the points a and b
  bool SameImage(int a, int b) const { return !Before(a, b) && !Before(b, a); }

  std::vector<Place> points_;
  std::vector<int> track_;                 // of each point
  std::vector<std::vector<int>> members_;  // of each track, by frame and camera
  std::map<int, std::map<std::tuple<int, double, double>, int>> known_;  // by frame
};

// A number for each of the matches of a frame pair: matches of one number are of one point.
// `same_time1` and `same_time2` are matches between the cameras at one time. Matches of a camera
// with itself are joined first, then the others by their score. A match that contradicts better
// ones has a number of its own.
std::vector<int64_t> LandmarkNumbers(const std::vector<Match>& matches,
                                     const std::vector<Match>& same_time1,
                                     const std::vector<Match>& same_time2);

// Adds the matches of a frame pair to tracks, with what its column `landmark` says. Pairs come in
// the order of their frames.
void AddPairToTracks(const FramePair& pair, int frame1, int frame2, TrackBuilder* tracks);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IMAGES_LANDMARK_TRACKS_H_

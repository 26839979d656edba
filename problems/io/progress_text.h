// How far a long run is, in words.
#ifndef RIGEL_PROBLEMS_IO_PROGRESS_TEXT_H_
#define RIGEL_PROBLEMS_IO_PROGRESS_TEXT_H_

#include <string>

namespace rigel {

// "3 of 100, 2.5 per second, 39 s left", with what is known: nothing is if none is done or no time
// has passed, and no time is left of the last. A slow run has "12 s each" in place of the rate.
std::string ProgressText(int done, int total, double seconds);

}  // namespace rigel

#endif  // RIGEL_PROBLEMS_IO_PROGRESS_TEXT_H_

#pragma once
// Arrivals that a host hands over in batches, at whole multiples of a time: where a run's grid lies, when
// each frame then comes, and which short batches its waits look like.

#include "gap/models/model.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace puckloop::gap {

/// The rows of each chain, at most `longest` together, as [from, to).
std::vector<std::pair<std::size_t, std::size_t>> stretches_of(const Observable& arrivals,
                                                              std::size_t longest);

/// Shorter than ten times the doubt of when a frame was ready (3 ms): an arrival cannot say which batch it is
/// of, but how long frames waited, as a function of when they were ready, is a saw of the batch.
bool is_fine_batch(double batch);

/// Where a chain's batches leave, s, and what its frames wait at least beyond the time that they are ready
/// by: `least` by the first thirtieth of them, `first` by the very first.
struct BatchGrid {
    double batch, phase, least, first;
    /// What a frame waits for its batch, whether it was received then or not.
    double wait(double ready) const;
};

/// Of rows [from, to) of `arrivals`, one chain, and a batch that is not fine.
BatchGrid grid_of(const Observable& arrivals, std::size_t from, std::size_t to, double batch,
                  const std::vector<double>& ready);

/// Where frames come when they are handed over in batches, s, of all rows.
struct Placed {
    std::vector<double> mean;
    std::vector<double> extra;  ///< of a fine batch: the sd of frames that may catch either of two
    std::vector<double> later;  ///< of others: by how many batches the arrival shows a frame to miss the next
    std::vector<double> before;  ///< and by how much of a batch it is ready before that leaves
};

/// Rows [from, to) of `arrivals`, one chain. `ready`: when each would come by itself, up to a zero of the
/// run's own. The run's grid is placed where arrivals themselves lie; of a fine batch each half of the run is
/// placed by the other, for a saw so fine follows any slow error of the rows that it was placed by. Returns
/// the sum of the distances from the nearest batch that a frame may have caught.
double place_batches(const Observable& arrivals, std::size_t from, std::size_t to, double batch,
                     const std::vector<double>& ready, Placed& placed);

/// Where the frames of a chain go on as evenly as batches do, but for the `rounding` of the robot's clock
/// (s), nothing shows that they waited, and a grid of their own rate would be a clock of another: there
/// batches that are not fine follow the frames, and show by the steps of arrivals alone.
void follow_even_frames(std::size_t from, std::size_t to, double batch, double rounding,
                        const std::vector<double>& ready, Placed& placed);

/// Fine batches show by how waits fall and jump: where the loop meets them at less than half of their phases
/// (`begun`: when it was at each frame, s) only what frames hold parts them, of which any function looks so.
/// There they do nothing.
void pass_over_locked(std::size_t from, std::size_t to, double batch, const std::vector<double>& begun,
                      const std::vector<double>& ready, Placed& placed);

/// How likely each row's batch was before it was seen: the next one as often as frames caught it that were
/// ready as long before, any other alike.
std::vector<double> chances_of(const Placed& placed);

/// Batches from `shortest` to 20 ms that waits beat with, the likeliest few; `between`: usual time between
/// frames. They are looked for in stretches of a few rows, over which few frequencies differ, then in whole
/// runs; frames at even times beat alike with many, which are then tried one by one.
std::vector<double> beats_of_waits(const Observable& arrivals, const std::vector<double>& ready,
                                   double shortest, double between);

}  // namespace puckloop::gap

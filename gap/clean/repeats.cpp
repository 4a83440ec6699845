// Readings that were logged again, not measured again: each stands a number of times in a row, with new
// times.
//
// Two things together show it. All stretches of equal readings are as many rows long, or a multiple: noise
// that leaves a reading as it is now and then makes stretches of any length. And readings of the same that do
// not follow each other agree far less often: where an instrument stands still, or its noise is below its
// step, they agree as well.

#include "gap/clean/clean.h"
#include "gap/data/columns.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace puckloop::gap {

namespace {

constexpr std::size_t kMostTimes = 100;   // in a row; more is an instrument that stands still
constexpr std::size_t kLeastBlocks = 20;  // stretches that show it
constexpr double kAllBut = 0.01;          // of the stretches: rows may be missing
constexpr double kMissing = -1e300;       // as a value that is alike in all rows
constexpr double kSurely = -13.8;         // ln of the chance that readings agree so, one in a million

/// Rows [from, from + rows) of a chain, all of the same.
struct Block {
    std::size_t rows;
    std::vector<double> what, reading;
    bool whole;  ///< the chain goes on at both ends
};

/// Rows of a run that belong together in order of time: those of each sensor.
using Chain = std::vector<std::size_t>;

std::vector<Chain> chains_of(const Run& run) {
    std::map<double, Chain> by_sensor;
    const auto& sensor = run.has("sensor") ? run.column("sensor") : run.column("mic");
    for (std::size_t i = 0; i < run.rows; ++i)
        by_sensor[sensor.empty() || std::isnan(sensor[i]) ? 0.0 : sensor[i]].push_back(i);
    std::vector<Chain> chains;
    for (auto& [key, rows] : by_sensor)
        chains.push_back(std::move(rows));
    return chains;
}

std::vector<double> row_of(const Run& run, const std::vector<std::string>& columns, std::size_t row) {
    std::vector<double> values;
    for (const auto& name : columns) {
        const double value = run.has(name) ? run.column(name)[row] : NAN;
        values.push_back(std::isnan(value) ? kMissing : value);
    }
    return values;
}

class Repeats {
  public:
    explicit Repeats(const Experiment& experiment) {
        for (const ColumnInfo& info : columns_of(experiment.kind)) {
            if (!experiment.has(info.name)) continue;
            // What was read beside it (ambient light, a neighbour) is read anew where the reading is.
            if ((info.role == Role::Observable && info.high - info.low > 1) ||
                (info.role == Role::Covariate && info.unit == std::string_view("counts")))
                readings_.emplace_back(info.name);
            if (info.role == Role::Truth || info.role == Role::Stimulus) set_.emplace_back(info.name);
        }
        for (const Run& run : experiment.runs)
            for (const Chain& chain : chains_of(run))
                take(run, chain);
    }

    /// How often each reading stands in a row; 1: as often as it was measured.
    std::size_t times() const {
        for (std::size_t times = kMostTimes; times > 1; --times)
            if (are_multiples_of(times) && ln_chance(times) < kSurely) return times;
        return 1;
    }

    /// Rows that only repeat the one before.
    std::vector<std::size_t> again(const Run& run, std::size_t times) const {
        std::vector<std::size_t> rows;
        for (const Chain& chain : chains_of(run))
            for (std::size_t from = 0; from < chain.size();) {
                const std::size_t to = end_of(run, chain, from);
                for (std::size_t k = from; k < to; ++k)
                    if ((k - from) % times != 0) rows.push_back(chain[k]);
                from = to;
            }
        std::ranges::sort(rows);
        return rows;
    }

  private:
    std::size_t end_of(const Run& run, const Chain& chain, std::size_t from) const {
        const auto same = [&](std::size_t k) {
            const std::size_t row = chain[k];
            // A row whose clock stands as well is a copy (drop_copies).
            const bool later = !run.has("t_s") || run.column("t_s")[row] != run.column("t_s")[chain[k - 1]];
            return later && row_of(run, readings_, row) == row_of(run, readings_, chain[from]) &&
                   row_of(run, set_, row) == row_of(run, set_, chain[from]);
        };
        std::size_t to = from + 1;
        while (to < chain.size() && same(to))
            ++to;
        return to;
    }

    void take(const Run& run, const Chain& chain) {
        for (std::size_t from = 0; from < chain.size();) {
            const std::size_t to = end_of(run, chain, from);
            blocks_.push_back({to - from, row_of(run, set_, chain[from]), row_of(run, readings_, chain[from]),
                               from > 0 && to < chain.size()});
            from = to;
        }
    }

    bool are_multiples_of(std::size_t times) const {
        std::size_t whole = 0, others = 0;
        for (const Block& block : blocks_) {
            if (!block.whole) continue;
            ++whole;
            others += block.rows % times != 0 ? 1 : 0;
        }
        return whole >= kLeastBlocks && static_cast<double>(others) <= kAllBut * static_cast<double>(whole);
    }

    /// That readings of the same agree in all rows that only repeat, if they do so as often as those that do
    /// not follow each other.
    double ln_chance(std::size_t times) const {
        std::map<std::vector<double>, std::map<std::vector<double>, double>> blocks;
        std::map<std::vector<double>, double> repeated;
        for (const Block& block : blocks_) {
            const auto own = static_cast<double>(block.rows / times);
            blocks[block.what][block.reading] += std::max(own, 1.0);
            repeated[block.what] += static_cast<double>(block.rows) -
                                    std::ceil(static_cast<double>(block.rows) / static_cast<double>(times));
        }
        double sum = 0.0;
        for (const auto& [what, readings] : blocks) {
            double all = 0.0, alike = 0.0;
            for (const auto& [reading, count] : readings) {
                all += count;
                alike += count * (count - 1);
            }
            // Two more that agree: where few were read again little is known.
            sum += repeated[what] * std::log((alike + 2) / (all * (all - 1) + 2));
        }
        return sum;
    }

    std::vector<std::string> readings_, set_;
    std::vector<Block> blocks_;
};

}  // namespace

void drop_repeats(Experiment& experiment) {
    // A tracker's or a loop's rows are series of their own: there a sample that is held is a late one.
    if (experiment.kind == Kind::Motion || experiment.kind == Kind::Timing) return;
    const Repeats repeats(experiment);
    const std::size_t times = repeats.times();
    if (times == 1) return;
    std::size_t rows = 0, gone = 0;
    for (Run& run : experiment.runs) {
        const auto again = repeats.again(run, times);
        rows += run.rows;
        gone += again.size();
        take_out(run, {again.begin(), again.end()});
    }
    experiment.caution(
        "each reading stands {} times in a row, which chance does not: logged again, not measured "
        "again; {} of {} rows repeat the one before and are left out. Log a reading once",
        times, gone, rows);
}

}  // namespace puckloop::gap

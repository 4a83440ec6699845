// Readings that were logged again, not measured again: each stands a number of times in a row, with new
// times.
//
// Two things together show it. All stretches of equal readings are as many rows long, or a multiple: noise
// that leaves a reading as it is now and then makes stretches of any length. And readings of the same that do
// not follow each other agree far less often: where an instrument stands still, or its noise is below its
// step, they agree as well.

#include "gap/clean/clean.h"
#include "gap/kinds/columns.h"
#include "gap/kinds/description.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>

namespace puckloop::gap {

namespace {

constexpr std::size_t kMostTimes = 100;   // in a row; more is an instrument that stands still
constexpr std::size_t kLeastBlocks = 20;  // stretches that show it
constexpr double kAllBut = 0.01;          // of the stretches: rows may be missing
constexpr double kMissing = -1e300;       // as a value that is alike in all rows
constexpr double kSurely = -13.8;         // ln of the chance that readings agree so, one in a million

/// Rows of a run that belong together in order of time: those of each sensor.
using Chain = std::vector<std::size_t>;

/// Rows behind each other in a chain, all of the same.
struct Block {
    Chain rows;
    std::vector<double> what, reading;
    bool whole;  ///< the chain goes on at both ends
};

std::vector<Chain> chains_of(const Run& run, const std::string& chain) {
    std::map<double, Chain> by_sensor;
    const auto& sensor = !chain.empty()      ? run.column(chain)
                         : run.has("sensor") ? run.column("sensor")
                                             : run.column("mic");
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
        if (const Description* own = experiment.kind.description()) chain_ = own->chain;
        for (const ColumnInfo& info : columns_of(experiment.kind)) {
            if (!experiment.has(info.name)) continue;
            // What was read beside it (ambient light, a neighbour) is read anew where the reading is.
            if ((info.role == Role::Observable && info.high - info.low > 1) ||
                (info.role == Role::Covariate && info.unit == std::string_view("counts")))
                readings_.emplace_back(info.name);
            if (info.role == Role::Truth || info.role == Role::Stimulus) set_.emplace_back(info.name);
        }
        for (const Run& run : experiment.runs)
            std::ranges::move(blocks_of(run), std::back_inserter(blocks_));
    }

    /// How often each reading stands in a row; 1: as often as it was measured.
    std::size_t times() const {
        for (std::size_t times = kMostTimes; times > 1; --times)
            if (are_multiples_of(times) && ln_chance(times) < kSurely) return times;
        return 1;
    }

    /// Rows that only repeat the one before.
    std::set<std::size_t> again(const Run& run, std::size_t times) const {
        std::set<std::size_t> rows;
        for (const Block& block : blocks_of(run))
            for (std::size_t k = 0; k < block.rows.size(); ++k)
                if (k % times != 0) rows.insert(block.rows[k]);
        return rows;
    }

  private:
    std::vector<Block> blocks_of(const Run& run) const {
        std::vector<Block> blocks;
        const auto& time = run.column("t_s");
        for (const Chain& chain : chains_of(run, chain_)) {
            const std::size_t first = blocks.size();
            for (std::size_t k = 0; k < chain.size(); ++k) {
                auto what = row_of(run, set_, chain[k]), reading = row_of(run, readings_, chain[k]);
                // A row whose clock stands as well is a copy (drop_copies).
                const bool later = k > 0 && (time.empty() || time[chain[k]] != time[chain[k - 1]]);
                if (later && what == blocks.back().what && reading == blocks.back().reading)
                    blocks.back().rows.push_back(chain[k]);
                else
                    blocks.push_back({{chain[k]}, std::move(what), std::move(reading), true});
            }
            blocks[first].whole = blocks.back().whole = false;
        }
        return blocks;
    }

    bool are_multiples_of(std::size_t times) const {
        std::size_t whole = 0, others = 0;
        for (const Block& block : blocks_) {
            if (!block.whole) continue;
            ++whole;
            others += block.rows.size() % times != 0 ? 1 : 0;
        }
        return whole >= kLeastBlocks && static_cast<double>(others) <= kAllBut * static_cast<double>(whole);
    }

    /// That readings of the same agree in all rows that only repeat, if they do so as often as those that do
    /// not follow each other.
    double ln_chance(std::size_t times) const {
        std::map<std::vector<double>, std::map<std::vector<double>, double>> blocks;
        std::map<std::vector<double>, double> repeated;
        for (const Block& block : blocks_) {
            const std::size_t rows = block.rows.size(), measured = (rows + times - 1) / times;
            blocks[block.what][block.reading] += static_cast<double>(std::max<std::size_t>(rows / times, 1));
            repeated[block.what] += static_cast<double>(rows - measured);
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

    std::string chain_;  // column of a described kind
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
        take_out(run, again);
    }
    experiment.caution(
        "each reading stands {} times in a row, which chance does not: logged again, not measured "
        "again; {} of {} rows repeat the one before and are left out. Log a reading once",
        times, gone, rows);
}

}  // namespace puckloop::gap

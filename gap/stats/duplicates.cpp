#include "gap/stats/duplicates.h"

#include "gap/stats/robust.h"
#include "gap/stats/series.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace puckloop::gap::stats {

namespace {

constexpr double kOnceInThousand = 10.0;  // bits
constexpr int kMostDecimals = 12;
constexpr double kRecurring = 0.7;   // distinct values a row, at most, where values recur
constexpr double kSameShare = 1e-9;  // of the range

/// Smallest power of ten (down to 1e-12) of which all values are multiples; quantum of how they were written.
double written_quantum(const std::vector<double>& values) {
    double quantum = 1.0;
    for (int decimals = 0; decimals <= kMostDecimals; ++decimals, quantum /= 10) {
        const bool fits = std::ranges::all_of(values, [quantum](double v) {
            const double steps = v / quantum;
            return !std::isfinite(v) ||
                   std::fabs(steps - std::round(steps)) < 1e-4 + 1e-12 * std::fabs(steps);
        });
        if (fits) return quantum;
    }
    return quantum;
}

/// Smallest difference between distinct values where values recur (counts, also after a change of unit);
/// otherwise the decimal place they are written to.
double quantum_of(std::vector<double> values) {
    values = finite(values);
    std::ranges::sort(values);
    const auto all = static_cast<double>(values.size());
    values.erase(std::unique(values.begin(), values.end()), values.end());
    if (values.size() < 2 || static_cast<double>(values.size()) > kRecurring * all)
        return written_quantum(values);
    const double least = kSameShare * (values.back() - values.front());  // less is rounding of one value
    double quantum = values.back() - values.front();
    for (std::size_t i = 1; i < values.size(); ++i)
        if (values[i] - values[i - 1] > least) quantum = std::min(quantum, values[i] - values[i - 1]);
    return quantum;
}

/// Bits that the equality of two rows' values in one column is worth.
class Column {
  public:
    explicit Column(const std::vector<double>& values) {
        for (const double v : values)
            if (std::isfinite(v)) ++count_[v], total_ += 1;
        const double spread = robust_scale(steps_of(values));  // beyond following its neighbour
        bits_ = spread > 0 ? std::max(std::log2(spread / quantum_of(values)), 0.0) : 0.0;
    }

    double bits(double value) const {
        const auto found = count_.find(value);
        if (found == count_.end() || value == 0) return 0.0;  // zero is where things start and end
        const double others = found->second - 2;              // beyond the pair itself
        return others > 0 ? std::min(bits_, std::log2(total_ / others)) : bits_;
    }

  private:
    std::map<double, double> count_;
    double total_ = 0, bits_ = 0;
};

struct Place {
    std::size_t run, row;
};

using Columns = std::vector<std::vector<double>>;

std::vector<double> row_of(const Columns& columns, std::size_t row) {
    std::vector<double> values;
    for (const auto& column : columns)
        values.push_back(column[row]);
    return values;
}

std::size_t rows_in(const MeasuredRun& run) {
    return run.measured.empty() ? 0 : run.measured.front().size();
}

bool complete(const std::vector<double>& values) {
    return !values.empty() && std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
}

}  // namespace

std::vector<Copy> copies_in(const std::vector<MeasuredRun>& runs) {
    if (runs.empty() || runs.front().measured.empty()) return {};
    std::vector<Column> columns;
    std::size_t total = 0;
    for (const MeasuredRun& run : runs)
        total += rows_in(run);
    for (std::size_t c = 0; c < runs.front().measured.size(); ++c) {
        std::vector<double> all;
        for (const MeasuredRun& run : runs)
            all.insert(all.end(), run.measured[c].begin(), run.measured[c].end());
        columns.emplace_back(all);
    }
    const auto bits_of = [&](const std::vector<double>& values) {
        double bits = 0;
        for (std::size_t c = 0; c < values.size(); ++c)
            bits += columns[c].bits(values[c]);
        return bits;
    };
    const double needed =
        kOnceInThousand + 2 * std::log2(static_cast<double>(std::max<std::size_t>(total, 2)));
    std::map<std::vector<double>, std::vector<Place>> seen;
    std::set<std::vector<std::size_t>> inside;  // pairs that belong to a copy already found
    std::vector<Copy> copies;
    constexpr std::size_t kMostAlike = 8;  // rows that more than these share are levels, not copies
    for (std::size_t r = 0; r < runs.size(); ++r)
        for (std::size_t i = 0; i < rows_in(runs[r]); ++i) {
            const std::vector<double> values = row_of(runs[r].measured, i);
            if (!complete(values)) continue;
            auto& earlier = seen[values];
            for (const Place& p : earlier) {
                if (earlier.size() > kMostAlike || inside.contains({p.run, p.row, r, i})) continue;
                Copy copy{p.run, p.row, r, i, 0, 0.0};
                while (copy.row_b + copy.rows < rows_in(runs[r]) &&
                       copy.row_a + copy.rows < (p.run == r ? i : rows_in(runs[p.run]))) {
                    const std::vector<double> a = row_of(runs[p.run].measured, copy.row_a + copy.rows);
                    if (!complete(a) || a != row_of(runs[r].measured, copy.row_b + copy.rows)) break;
                    inside.insert({p.run, copy.row_a + copy.rows, r, copy.row_b + copy.rows});
                    if (copy.rows == 0 || a != row_of(runs[p.run].measured, copy.row_a + copy.rows - 1))
                        copy.bits += bits_of(a);
                    ++copy.rows;
                }
                const bool held = p.run == r && copy.row_a + copy.rows >= i &&
                                  row_of(runs[r].keys, p.row) == row_of(runs[r].keys, i);
                if (!held && copy.bits > needed) copies.push_back(copy);
            }
            if (earlier.size() <= kMostAlike) earlier.push_back({r, i});
        }
    return copies;
}

}  // namespace puckloop::gap::stats

#pragma once
// A table as numbers that may be learnt: places along one covariate or two, straight lines between them, and
// a Gaussian process's prior over the values at the places (Matern 3/2), as the root of its covariance. A way
// along an axis counts half by the covariate's range and half by the share of the rows that lies on it.

#include "gap/extension/subjects.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace puckloop::gap {

/// Which table: over these covariates of a subject (none: one number), a share of `times` (-1: of 1), the
/// same for all sensors or one for each, or one number for each run.
struct TableShape {
    std::vector<std::size_t> over;
    int times = -1;
    bool by_sensor = false, by_run = false;

    bool operator==(const TableShape&) const = default;
};

/// The part of a moment's term that each value of a table makes: at most four of them.
struct MomentWeights {
    std::array<std::size_t, 4> at{};
    std::array<double, 4> weight{};  ///< 0: none
};

/// How smooth a table is.
struct Kernel {
    std::array<double, 2> lengths{1.0, 1.0};  ///< along each axis, in shares of it
    bool round = true;                        ///< both ends of an angle are one place
};

/// Places along one covariate, and where every moment of a subject lies among them.
struct LaidAxis {
    std::vector<double> at, along;     ///< and how far along the axis each place is, 0 to 1
    std::vector<std::uint16_t> above;  ///< of a moment: the place above it
    std::vector<double> share;         ///< of the way from the place below to the one above
};

/// The axes of a subject's tables, each laid once. By the rows in `used`: half by where they are, half by the
/// range, so that neither a crowd nor a stray value takes all places; from end to end of all rows.
class LaidAxes {
  public:
    /// Keeps references to both.
    LaidAxes(const Subject& subject, const std::vector<char>& used) : subject_(subject), used_(used) {}

    const Subject& subject() const { return subject_; }
    /// `most` places along a covariate of the subject.
    const LaidAxis& axis(std::size_t covariate, std::size_t most);

  private:
    const Subject& subject_;
    const std::vector<char>& used_;
    std::map<std::pair<std::size_t, std::size_t>, LaidAxis> laid_;
};

class TableBasis {
  public:
    /// `most` places along each axis.
    TableBasis(LaidAxes& axes, const TableShape& shape, std::size_t most);

    const TableShape& shape() const { return shape_; }
    const std::vector<std::vector<double>>& places() const { return places_; }
    std::size_t values() const { return values_; }  ///< of one table
    std::size_t tables() const { return tables_; }  ///< sensors, runs, or one
    bool empty() const { return values_ == 0; }

    /// Calls `add(value, weight)` for all that make row i's term, of a subject of the same covariates; the
    /// index of its table apart.
    template <class Add>
    void of_row(const Subject& subject, std::size_t i, const Add& add) const {
        for (std::size_t m = subject.moments[i]; m < subject.moments[i + 1]; ++m)
            add_moment(
                begun(subject, m), [&](std::size_t k) { return found(subject, k, m); }, add);
    }
    /// The same of the subject that the axes were laid for, `axes` being its own: quicker.
    template <class Add>
    void of_row(const Subject& subject, const std::vector<const LaidAxis*>& axes, std::size_t i,
                const Add& add) const {
        for (std::size_t m = subject.moments[i]; m < subject.moments[i + 1]; ++m)
            add_moment(
                begun(subject, m),
                [&](std::size_t k) {
                    return Found{axes[k]->above[m], axes[k]->share[m]};
                },
                add);
    }
    std::size_t table_of(const Subject& subject, std::size_t i) const;

    /// values = root * z, z independent of unit size.
    Eigen::MatrixXd root(const Kernel& kernel) const;
    bool goes_round() const { return std::ranges::find(periodic_, 1) != periodic_.end(); }

  private:
    /// Between which places a value lies.
    struct Found {
        std::size_t above;
        double share;
    };
    Found found(const Subject& subject, std::size_t axis, std::size_t m) const;
    double begun(const Subject& subject, std::size_t m) const {
        return shape_.times < 0
                   ? subject.weight[m]
                   : subject.weight[m] * subject.covariates[static_cast<std::size_t>(shape_.times)].value[m];
    }
    std::size_t corners() const { return std::size_t{1} << places_.size(); }

    template <class Find, class Add>
    void add_moment(double weight, const Find& find, const Add& add) const {
        MomentWeights own;
        own.weight[0] = weight;
        std::size_t count = 1;
        for (std::size_t k = 0; k < places_.size(); ++k) {
            const std::size_t size = places_[k].size();
            const auto [above, share] = find(k);
            for (std::size_t c = 0; c < count; ++c) {
                own.at[c + count] = own.at[c] * size + above;
                own.weight[c + count] = own.weight[c] * share;
                own.at[c] = own.at[c] * size + above - 1;
                own.weight[c] *= 1 - share;
            }
            count *= 2;
        }
        for (std::size_t c = 0; c < corners(); ++c)
            add(own.at[c], own.weight[c]);
    }

    TableShape shape_;
    std::vector<std::vector<double>> places_, along_;  // and how far along its axis each is, 0 to 1
    std::vector<char> periodic_;
    std::size_t values_ = 1, tables_ = 1;
};

}  // namespace puckloop::gap

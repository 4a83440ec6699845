#pragma once
// How the innovations of a sum answer when something is added to it in some of its rows: the filter again,
// with the gains that it had. It is linear then; what an outlier is trusted with stays as it was.

#include "gap/fit/noise.h"
#include "gap/models/model.h"

#include <Eigen/Core>

#include <vector>

namespace puckloop::gap {

class SumResponse {
  public:
    /// Of an observable of kind Level; chances of lapses are left out.
    SumResponse(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise);

    /// Standardised innovations; NaN where a row says nothing.
    const std::vector<double>& innovations() const { return z_; }

    /// Row i adds `amount[i]` (the observable's unit; what a chain's first row adds is not seen) to the sum
    /// if it lies in a cell. Calls `take(i, answers)` for every row that says something, with an answer for
    /// each cell.
    template <class Take>
    void respond(const std::vector<int>& cell, int cells, const std::vector<double>& amount,
                 const Take& take) const {
        Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(cells), level = sum, error = sum, answer = sum;
        for (std::size_t i = 0; i < z_.size(); ++i) {
            if (role_[i] == Role::Begins) {
                sum.setZero();
                level.setZero();
                error.setZero();
                continue;
            }
            if (cell[i] >= 0) sum[cell[i]] += amount[i];
            if (role_[i] == Role::Silent) continue;
            answer = sum - level - memory_ * error;
            level += gain_[i] * answer;
            error = memory_ * error + (1 - gain_[i]) * answer;
            answer *= 1 / sd_[i];
            take(i, answer);
        }
    }

  private:
    enum class Role : char { Silent, Begins, Follows };
    double memory_;
    std::vector<Role> role_;
    std::vector<double> z_, sd_, gain_;
};

}  // namespace puckloop::gap

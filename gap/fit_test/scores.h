#pragma once
// What the innovations of one observable say of a number that the model does not have: a shift of its mean by
// so much in each row.

#include "gap/fit/fit.h"
#include "gap/fit/likelihood.h"
#include "gap/models/model.h"

#include <vector>

namespace puckloop::gap {

/// An observable at a state: its innovations with their weight in the noise's likelihood.
class Scores {
  public:
    Scores(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise);

    /// Of each row, dz / d(amount of `shift`) times -1: how an innovation answers when the model lacks one
    /// unit of `shift` (the observable's unit a unit of the number; an Event's in logits). 0 where a row says
    /// nothing.
    std::vector<double> answers(const std::vector<double>& shift) const;

    /// First derivative of each row's log likelihood by its innovation, bounded where tails are heavy.
    const std::vector<double>& pull() const { return pull_; }
    /// Expected curvature of a plain row.
    double curvature() const { return curvature_; }
    const std::vector<double>& innovations() const { return innovation_; }

  private:
    const Observable& observable_;
    const Predicted& predicted_;
    NoiseParameters noise_;
    Innovations filtered_;
    std::vector<double> innovation_, pull_;
    double curvature_ = 1.0;
};

}  // namespace puckloop::gap

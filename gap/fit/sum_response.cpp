#include "gap/fit/sum_response.h"

#include "gap/fit/filter.h"

#include <cmath>
#include <limits>

namespace puckloop::gap {

SumResponse::SumResponse(const Observable& observable, const Predicted& predicted,
                         const NoiseParameters& noise)
    : memory_(noise.memory) {
    const std::size_t n = observable.y.size();
    Predicted calm = predicted;
    calm.lapse.clear();
    calm.lapse_scale.clear();
    Innovations innovations;
    filter(observable, calm, noise, innovations, &gain_);
    role_.assign(n, Role::Silent);
    z_.assign(n, std::numeric_limits<double>::quiet_NaN());
    sd_.assign(n, 1.0);
    bool begun = false;
    for (std::size_t i = 0; i < n; ++i) {
        if (observable.starts[i] != 0) begun = false;
        const bool seen = innovations.role[i] == RowRole::Plain || innovations.role[i] == RowRole::First;
        role_[i] = !seen ? Role::Silent : begun ? Role::Follows : Role::Begins;
        begun = seen;
        if (role_[i] != Role::Follows) continue;
        z_[i] = innovations.z[i];
        sd_[i] = std::sqrt(innovations.variance[i]);
    }
}

}  // namespace puckloop::gap

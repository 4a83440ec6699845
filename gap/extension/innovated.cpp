#include "gap/extension/innovated.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

double Innovated::score(double squares_left) const {
    return -rows / 2 * std::log(squares_left / rows) - log_sizes;
}

Innovated innovated(const LearningRows& rows, const std::vector<double>& error, const ErrorsLaw& law,
                    const Whitening& whitening) {
    std::vector<double> z = error;
    whitening.apply(z);
    Innovated all;
    all.z = Eigen::Map<Eigen::VectorXd>(z.data(), static_cast<Eigen::Index>(z.size()));
    all.weight = Eigen::VectorXd::Zero(all.z.size());
    for (std::size_t k = 0; k < rows.row.size(); ++k) {
        if (!(whitening.scale(k) > 0)) continue;
        const auto place = static_cast<Eigen::Index>(k);
        const double scaled = all.z[place] / law.sd;
        all.weight[place] = std::min(1.0, (law.tail + 1) / (law.tail + scaled * scaled));
        all.squares += all.weight[place] * all.z[place] * all.z[place];
        all.rows += all.weight[place];
    }
    all.rows = std::max(all.rows, 1.0);
    all.squares = std::max(all.squares, 1e-300);
    all.log_sizes = whitening.log_sizes();
    return all;
}

}  // namespace puckloop::gap

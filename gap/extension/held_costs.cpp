#include "gap/extension/held_costs.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What is believed of all numbers of the term: the tables' values, then an offset that a run has for itself
/// for each part that has them.
struct Belief {
    VectorXd mean;
    MatrixXd covariance;
    std::vector<Index> first;  // of each part's numbers

    explicit Belief(const Learnt& learnt) {
        Index tables = 0, offsets = 0;
        for (const LearntPart& part : learnt.parts)
            (part.basis.shape().by_run ? offsets : tables) +=
                part.basis.shape().by_run ? 1 : part.value.size();
        mean = VectorXd::Zero(tables + offsets);
        covariance = MatrixXd::Zero(tables + offsets, tables + offsets);
        covariance.topLeftCorner(tables, tables) = learnt.covariance;
        Index table = 0, offset = tables;
        for (const LearntPart& part : learnt.parts)
            if (part.basis.shape().by_run) {
                covariance(offset, offset) = part.spread * part.spread;
                first.push_back(offset++);
            } else {
                mean.segment(table, part.value.size()) = part.value;
                first.push_back(table);
                table += part.value.size();
            }
    }
};

/// The rows of one run that were held out.
LearningRows held_rows(const Subject& subject, const std::vector<char>& used, std::size_t& next) {
    LearningRows rows;
    while (next < used.size() && used[next] != 0)
        ++next;
    if (next == used.size()) return rows;
    const std::uint32_t run = subject.run[next];
    for (; next < used.size() && subject.run[next] == run; ++next) {
        if (used[next] == 0) rows.add(subject, next, !rows.row.empty() && rows.row.back() + 1 == next);
    }
    return rows;
}

/// What each number makes of these rows, as innovations.
MatrixXd design_of_rows(const Subject& subject, const LearningRows& rows, const Learnt& learnt,
                        const Belief& belief, const Whitening& whitening) {
    MatrixXd all = MatrixXd::Zero(static_cast<Index>(rows.row.size()), belief.mean.size());
    for (std::size_t k = 0; k < rows.row.size(); ++k) {
        const auto place = static_cast<Index>(k);
        if (subject.sums && rows.starts[k] == 0) all.row(place) = all.row(place - 1);
        for (std::size_t p = 0; p < learnt.parts.size(); ++p) {
            const TableBasis& basis = learnt.parts[p].basis;
            const std::size_t table =
                basis.shape().by_run ? 0 : basis.table_of(subject, rows.row[k]) * basis.values();
            basis.of_row(subject, rows.row[k], [&](std::size_t value, double weight) {
                all(place, belief.first[p] + static_cast<Index>(table + value)) += weight;
            });
        }
    }
    for (Index c = 0; c < all.cols(); ++c)
        whitening.apply({all.col(c).data(), rows.row.size()});
    return all;
}

}  // namespace

std::vector<double> held_costs(const Subject& subject, const std::vector<char>& used, const Learnt& learnt,
                               bool with_term) {
    std::vector<double> costs(used.size(), 0.0);
    Learnt nothing;
    nothing.law = learnt.law_without;
    const Learnt& term = with_term && !learnt.parts.empty() ? learnt : nothing;
    const ErrorsLaw& law = term.law;
    const Belief before(term);
    for (std::size_t next = 0; next < used.size();) {
        const LearningRows rows = held_rows(subject, used, next);
        if (rows.row.empty()) break;
        const Whitening whitening(law, rows.known, rows.starts);
        std::vector<double> z = rows.error;
        whitening.apply(z);
        const MatrixXd design = design_of_rows(subject, rows, term, before, whitening);
        VectorXd mean = before.mean;
        MatrixXd covariance = before.covariance;
        for (std::size_t k = 0; k < z.size(); ++k) {
            if (!(whitening.scale(k) > 0)) continue;
            const VectorXd own = design.row(static_cast<Index>(k));
            const VectorXd shared = covariance * own;
            const double unsure = std::max(own.dot(shared), 0.0), noise = law.sd * law.sd;
            const double left = z[k] - own.dot(mean), size = std::sqrt(noise + unsure);
            costs[rows.row[k]] =
                std::log(size) - std::log(whitening.scale(k)) - student_log_density(left / size, law.tail);
            // What the row says of the tables, where it is astray less (Student's law).
            const double weight = std::min(1.0, (law.tail + 1) / (law.tail + left * left / (noise + unsure)));
            const VectorXd gain = shared / (unsure + noise / weight);
            mean += gain * left;
            covariance.noalias() -= gain * shared.transpose();
        }
    }
    return costs;
}

}  // namespace puckloop::gap

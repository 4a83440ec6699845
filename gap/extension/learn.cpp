#include "gap/extension/learn.h"

#include "gap/extension/innovated.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace puckloop::gap {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kRowsToChoose = 3000;  // more are thinned
constexpr std::size_t kLeastToLearn = 40;    // of fewer nothing is learnt
constexpr std::size_t kMostParts = 5;        // tables of one term
constexpr std::size_t kMostValues = 420;     // of all of them: what is fitted together
constexpr double kClearly = 3.0;             // nats beyond the price of having looked at many
constexpr std::size_t kPlacesOfOne = 32;     // along an axis alone
/// Along each of two: they are looked at coarsely, and finely where one of them joins.
constexpr std::size_t kCoarsePlaces = 6, kFinePlaces = 12, kFinestPlaces = 18;
constexpr double kCoarseLengths[] = {0.1, 0.4};
constexpr double kFineLengths[] = {0.05, 0.12, 0.3, 1.0};  // of which evidence chooses
constexpr double kCalmerCarry =
    0.3;  // of the carried share that is tried besides: what adds up looks like it
constexpr double kCalmerWalk = 0.01;  // of a walk's variance, likewise
constexpr int kSizes = 25;            // of a table's prior size, over ten decades of its variance
constexpr int kRoundsOfSizes = 8;     // of sizes fitted together
constexpr double kLeastSize = 1e-8;   // variance of a value over that of the errors, of its share in the rows
constexpr std::size_t kFirst = 3;     // covariates that are looked at two by two for each sensor by itself

using Axes = std::vector<const LaidAxis*>;  // of one table

/// What one table's values make of the chosen rows, whitened: rows that feel it, and a column a value.
struct TableDesign {
    std::vector<std::size_t> rows;  // of the chosen ones
    MatrixXd columns;
};

/// The same before it is whitened: all chosen rows. `axes`: the table's own.
TableDesign plain_design(const Subject& subject, const LearningRows& chosen, const TableBasis& basis,
                         std::size_t table, const Axes& axes) {
    const std::size_t n = chosen.row.size();
    TableDesign design;
    std::vector<char> own(n, 0);
    for (std::size_t k = 0; k < n; ++k)
        own[k] = basis.table_of(subject, chosen.row[k]) == table ? 1 : 0;
    for (std::size_t k = 0; k < n; ++k)
        if (own[k] != 0 || (k > 0 && own[k - 1] != 0 && chosen.starts[k] == 0)) design.rows.push_back(k);
    const auto values = static_cast<Index>(basis.values());
    MatrixXd all = MatrixXd::Zero(static_cast<Index>(n), values);
    for (std::size_t k = 0; k < n; ++k) {
        const auto place = static_cast<Index>(k);
        if (subject.sums && k > 0 && chosen.starts[k] == 0) all.row(place) = all.row(place - 1);
        if (own[k] == 0) continue;
        basis.of_row(subject, axes, chosen.row[k], [&](std::size_t value, double weight) {
            all(place, static_cast<Index>(value)) += weight;
        });
    }
    design.columns = std::move(all);
    return design;
}

TableDesign whitened(const TableDesign& plain, const Whitening& whitening) {
    MatrixXd all = plain.columns;
    const Index values = all.cols();
    const auto n = static_cast<std::size_t>(all.rows());
    for (Index v = 0; v < values; ++v)
        whitening.apply({all.col(v).data(), n});
    TableDesign design{plain.rows, {}};
    if (design.rows.size() == n) {
        design.columns = std::move(all);
        return design;
    }
    design.columns.resize(static_cast<Index>(design.rows.size()), values);
    for (std::size_t k = 0; k < design.rows.size(); ++k)
        design.columns.row(static_cast<Index>(k)) = all.row(static_cast<Index>(design.rows[k]));
    return design;
}

/// A table that may join, with the size at which it would.
struct Offer {
    TableShape shape;
    std::size_t places = 0, setting = 0;  // setting: which law of errors
    Kernel kernel{};
    double size = 0.0, score = -INFINITY;
};

std::vector<Kernel> kernels_of(const TableBasis& basis, std::span<const double> each) {
    if (basis.places().empty()) return {{}};  // one number has none
    std::vector<Kernel> all;
    for (const bool round : {true, false})
        for (const double one : each)
            for (const double other : each)
                if ((round || basis.goes_round()) && (basis.places().size() > 1 || one == other))
                    all.push_back({{one, other}, round});
    return all;
}

/// A gram matrix G and a side s, turned so that any size of the prior costs no more than its diagonal is
/// long.
struct Tridiagonal {
    VectorXd diagonal, beside, side;

    Tridiagonal(const MatrixXd& gram, const VectorXd& of) {
        if (gram.rows() == 1) {
            diagonal = gram.diagonal();
            side = of;
            return;
        }
        const Eigen::Tridiagonalization<MatrixXd> turned(gram);
        diagonal = turned.diagonal();
        beside = turned.subDiagonal();
        side = turned.matrixQ().adjoint() * of;
    }

    /// Adds ln det(1 + size G) and size s' (1 + size G)^-1 s.
    void add(double size, double& log_det, double& taken) const {
        double pivot = 1.0, carried = 0.0;  // no pivot is below 1: G has no negative direction
        for (Index j = 0; j < diagonal.size(); ++j) {
            const double next = j == 0 ? 0.0 : size * beside[j - 1], share = next / pivot;
            pivot = std::max(1 + size * diagonal[j] - share * next, 1.0);
            carried = side[j] - share * carried;
            log_det += std::log(pivot);
            taken += size * carried * carried / pivot;
        }
    }
};

/// The evidence of a table, tables of sensors or runs being of one size: the best size and kernel.
void weigh(const TableBasis& basis, const std::vector<TableDesign>& tables,
           const std::vector<Kernel>& kernels, const Whitening& whitening, const Innovated& all,
           const Offer& as, Offer& best) {
    const auto m = static_cast<Index>(basis.values());
    std::vector<MatrixXd> grams;
    std::vector<VectorXd> sides;
    for (const TableDesign& table : tables) {
        if (table.rows.empty()) continue;
        const TableDesign design = whitened(table, whitening);
        VectorXd weight(design.columns.rows()), z(design.columns.rows());
        for (std::size_t k = 0; k < design.rows.size(); ++k) {
            weight[static_cast<Index>(k)] = all.weight[static_cast<Index>(design.rows[k])];
            z[static_cast<Index>(k)] = all.z[static_cast<Index>(design.rows[k])];
        }
        const MatrixXd scaled = weight.cwiseSqrt().asDiagonal() * design.columns;
        MatrixXd gram = MatrixXd::Zero(m, m);
        gram.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose());
        grams.emplace_back(gram.selfadjointView<Eigen::Lower>());
        sides.emplace_back(design.columns.transpose() * weight.cwiseProduct(z));
    }
    for (const Kernel& kernel : kernels) {
        const MatrixXd root = basis.root(kernel);
        std::vector<Tridiagonal> systems;
        double trace = 0.0;
        Index count = 0;
        for (std::size_t t = 0; t < grams.size(); ++t) {
            systems.emplace_back(root.transpose() * grams[t] * root, root.transpose() * sides[t]);
            trace += systems.back().diagonal.sum();
            count += m;
        }
        if (!(trace > 0)) continue;
        const double mean = trace / static_cast<double>(count);
        for (int k = 0; k < kSizes; ++k) {
            const double size = std::pow(10.0, -2.0 + 10.0 * k / (kSizes - 1)) / mean;
            double log_sum = 0.0, taken = 0.0;
            for (const Tridiagonal& system : systems)
                system.add(size, log_sum, taken);
            const double left = std::max(all.squares - taken, 1e-12 * all.squares);
            const double score = all.score(left) - log_sum / 2;
            if (score > best.score) best = {as.shape, as.places, as.setting, kernel, size, score};
        }
    }
}

/// All tables' values together, sizes by expectation and maximisation.
struct Joint {
    double sd = 1.0, freedom = 0.0;
    MatrixXd covariance;  // of all values but runs'
};

MatrixXd covariance_of(const std::vector<LearntPart>& parts, const std::vector<MatrixXd>& roots,
                       const MatrixXd& inverse, double sd) {
    struct Block {
        Index from, to, size;
        const MatrixXd* root;
    };
    std::vector<Block> blocks;
    Index from = 0, to = 0;
    for (std::size_t p = 0; p < parts.size(); ++p)
        for (std::size_t table = 0; table < parts[p].basis.tables(); ++table) {
            const auto size = static_cast<Index>(parts[p].basis.values());
            if (!parts[p].basis.shape().by_run) {
                blocks.push_back({from, to, size, &roots[p]});
                to += size;
            }
            from += size;
        }
    MatrixXd all(to, to);
    for (const Block& a : blocks)
        for (const Block& b : blocks)
            all.block(a.to, b.to, a.size, b.size) =
                sd * sd * (*a.root * inverse.block(a.from, b.from, a.size, b.size) * b.root->transpose());
    return all;
}

Joint fit_together(const Subject& subject, const LearningRows& chosen, const ErrorsLaw& law,
                   const std::vector<double>& error_now, const std::vector<Axes>& axes,
                   std::vector<LearntPart>& parts) {
    const Whitening whitening(law, chosen.known, chosen.starts);
    // Weights by what is left now; the values are fitted to the whole errors.
    const Innovated left = innovated(chosen, error_now, law, whitening);
    std::vector<double> whole = chosen.error;
    whitening.apply(whole);
    const VectorXd z = Eigen::Map<VectorXd>(whole.data(), static_cast<Index>(whole.size()));
    Index width = 0;
    for (const LearntPart& part : parts)
        width += static_cast<Index>(part.basis.values() * part.basis.tables());
    MatrixXd all = MatrixXd::Zero(z.size(), width);
    std::vector<MatrixXd> roots;
    Index first = 0;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const LearntPart& part = parts[p];
        roots.push_back(part.basis.root(part.kernel));
        const auto m = static_cast<Index>(part.basis.values());
        for (std::size_t table = 0; table < part.basis.tables(); ++table, first += m) {
            const TableDesign design =
                whitened(plain_design(subject, chosen, part.basis, table, axes[p]), whitening);
            const MatrixXd columns = design.columns * roots.back();
            for (std::size_t k = 0; k < design.rows.size(); ++k)
                all.block(static_cast<Index>(design.rows[k]), first, 1, m) =
                    columns.row(static_cast<Index>(k));
        }
    }
    const MatrixXd scaled = left.weight.cwiseSqrt().asDiagonal() * all;
    MatrixXd gram = MatrixXd::Zero(width, width);
    gram.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose());
    gram = MatrixXd(gram.selfadjointView<Eigen::Lower>());
    const VectorXd side = all.transpose() * left.weight.cwiseProduct(z);
    const double squares = (left.weight.array() * z.array().square()).sum();
    VectorXd found;
    MatrixXd inverse;
    Joint joint;
    for (int round = 0; round < kRoundsOfSizes; ++round) {
        MatrixXd precision = gram;
        first = 0;
        for (const LearntPart& part : parts) {
            const auto count = static_cast<Index>(part.basis.values() * part.basis.tables());
            precision.diagonal().segment(first, count).array() += 1 / part.size;
            first += count;
        }
        const Eigen::LLT<MatrixXd> solver(precision);
        found = solver.solve(side);
        inverse = solver.solve(MatrixXd::Identity(width, width));
        const double rest = std::max(squares - side.dot(found), 1e-12 * squares);
        joint.sd = std::sqrt(rest / left.rows);
        joint.freedom = 0.0;
        first = 0;
        for (LearntPart& part : parts) {
            const auto count = static_cast<Index>(part.basis.values() * part.basis.tables());
            const double own = found.segment(first, count).squaredNorm() / (joint.sd * joint.sd) +
                               inverse.diagonal().segment(first, count).sum();
            if (!part.basis.shape().by_run)
                joint.freedom +=
                    static_cast<double>(count) - inverse.diagonal().segment(first, count).sum() / part.size;
            if (round + 1 < kRoundsOfSizes)
                part.size = std::max(own / static_cast<double>(count), kLeastSize);
            first += count;
        }
    }
    first = 0;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        LearntPart& part = parts[p];
        const auto m = static_cast<Index>(part.basis.values());
        const auto tables = static_cast<Index>(part.basis.tables());
        part.value.resize(m * tables);
        part.sd.resize(m * tables);
        part.spread = std::sqrt(part.size) * joint.sd;
        for (Index t = 0; t < tables; ++t, first += m) {
            part.value.segment(t * m, m) = roots[p] * found.segment(first, m);
            const MatrixXd spread = roots[p] * inverse.block(first, first, m, m) * roots[p].transpose();
            part.sd.segment(t * m, m) = joint.sd * spread.diagonal().cwiseMax(0.0).cwiseSqrt();
        }
    }
    joint.covariance = covariance_of(parts, roots, inverse, joint.sd);
    return joint;
}

}  // namespace

std::vector<double> left_beside(const Subject& subject, const LearningRows& chosen,
                                const std::vector<LearntPart>& parts, bool runs_only) {
    std::vector<double> left = chosen.error;
    double sum = 0.0;
    for (std::size_t k = 0; k < chosen.row.size(); ++k) {
        double own = 0.0;
        for (const LearntPart& part : parts) {
            if (runs_only && !part.basis.shape().by_run) continue;
            const std::size_t table = part.basis.table_of(subject, chosen.row[k]) * part.basis.values();
            part.basis.of_row(subject, chosen.row[k], [&](std::size_t value, double weight) {
                own += weight * part.value[static_cast<Index>(table + value)];
            });
        }
        sum = subject.sums ? (chosen.starts[k] != 0 ? 0.0 : sum) + own : own;
        if (chosen.known[k] != 0) left[k] -= sum;
    }
    return left;
}

namespace {

/// Tables that are looked at alone; then two by two.
std::vector<TableShape> single_shapes(const Subject& subject) {
    std::vector<int> times{-1};
    for (std::size_t c = 0; c < subject.covariates.size(); ++c)
        if (subject.covariates[c].factor) times.push_back(static_cast<int>(c));
    std::vector<TableShape> shapes;
    for (const int factor : times)
        for (const bool by_sensor : {false, true}) {
            if (by_sensor && subject.sensors < 2) continue;
            // A sum that gains the same in each row is the walk's mean: allowed. Readings may be off by one.
            shapes.push_back({{}, factor, by_sensor, false});
            for (std::size_t c = 0; c < subject.covariates.size(); ++c)
                if (static_cast<int>(c) != factor || !subject.sums)
                    shapes.push_back({{c}, factor, by_sensor, false});
        }
    for (const int factor : times)
        shapes.push_back({{}, factor, false, true});
    return shapes;
}

std::vector<TableShape> pair_shapes(const Subject& subject, const std::vector<std::size_t>& first) {
    std::vector<TableShape> shapes;
    for (const TableShape& one : single_shapes(subject)) {
        if (one.over.size() != 1) continue;
        for (std::size_t other = one.over[0] + 1; other < subject.covariates.size(); ++other) {
            const auto leads = [&](std::size_t c) { return std::ranges::find(first, c) != first.end(); };
            if (one.by_sensor && !(leads(one.over[0]) && leads(other))) continue;
            shapes.push_back({{one.over[0], other}, one.times, one.by_sensor, false});
        }
    }
    return shapes;
}

/// The covariates whose own tables do best.
std::vector<std::size_t> leading(const std::vector<TableShape>& shapes, const std::vector<double>& scores,
                                 std::size_t covariates) {
    std::vector<double> best(covariates, -INFINITY);
    for (std::size_t k = 0; k < shapes.size(); ++k)
        if (shapes[k].over.size() == 1)
            best[shapes[k].over[0]] = std::max(best[shapes[k].over[0]], scores[k]);
    std::vector<std::size_t> order(covariates);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return best[a] > best[b]; });
    order.resize(std::min(order.size(), kFirst));
    return order;
}

class Learner {
  public:
    Learner(const Subject& subject, const std::vector<char>& used)
        : subject_(subject),
          used_(used),
          chosen_(learning_rows(subject, used, kRowsToChoose)),
          laid_(used.size(), 0) {
        for (const std::size_t row : chosen_.row)
            laid_[row] = 1;
    }

    Learnt learnt() {
        Learnt result;
        const LearningRows all = learning_rows(subject_, used_, kRowsToFit);
        result.law = result.law_without = law_of(subject_.sums, all.error, all.known, all.starts);
        if (chosen_.row.size() < kLeastToLearn) return result;
        law_ = law_of(subject_.sums, chosen_.error, chosen_.known, chosen_.starts);
        error_ = chosen_.error;
        while (parts_.size() < kMostParts && joined()) {
        }
        if (parts_.empty()) return result;
        // Values once more, by more rows and by the law of what is left.
        for (int round = 0; round < 2; ++round) {
            const auto left = left_beside(subject_, all, parts_);
            result.law = law_of(subject_.sums, left, all.known, all.starts);
            Joint joint = fit_together(subject_, all, result.law, left, part_axes_, parts_);
            result.freedom = joint.freedom;
            result.covariance = std::move(joint.covariance);
        }
        result.law = law_of(subject_.sums, left_beside(subject_, all, parts_), all.known, all.starts);
        result.evidence = evidence_;
        result.parts = std::move(parts_);
        return result;
    }

  private:
    /// Adds the table whose evidence is best, if it is enough.
    bool joined() {
        std::vector<ErrorsLaw> laws{law_};
        for (const double calmer : {subject_.sums ? kCalmerWalk : kCalmerCarry, 0.0})
            if (law_.number > 0) {
                laws.push_back(law_);
                laws.back().number *= calmer;
            }
        std::vector<Whitening> whitenings;
        std::vector<Innovated> innovations;
        double base = -INFINITY;
        for (const ErrorsLaw& law : laws) {
            whitenings.emplace_back(law, chosen_.known, chosen_.starts);
            innovations.push_back(innovated(chosen_, error_, law, whitenings.back()));
            // Rows weigh alike under both, else their scores would not compare.
            innovations.back().weight = innovations.front().weight;
            innovations.back().squares =
                (innovations.back().weight.array() * innovations.back().z.array().square()).sum();
            innovations.back().rows = innovations.front().rows;
            base = std::max(base, innovations.back().score(innovations.back().squares));
        }
        Offer best;
        // The best of a table of so many places; -infinity: it may not join.
        const auto offer_of = [&](const TableShape& shape, std::size_t places, std::span<const double> each,
                                  const Kernel* only = nullptr) {
            Offer own;
            const TableBasis basis(axes_, shape, places);
            const std::size_t size = basis.values() * basis.tables();
            const bool there = std::ranges::any_of(
                parts_, [&](const LearntPart& part) { return part.basis.shape() == shape; });
            if (there || basis.empty() || values() + size > kMostValues) return own;
            const Axes axes = axes_of(shape, places);
            std::vector<TableDesign> tables;
            for (std::size_t table = 0; table < basis.tables(); ++table)
                tables.push_back(plain_design(subject_, chosen_, basis, table, axes));
            for (std::size_t s = 0; s < laws.size(); ++s)
                weigh(basis, tables, only != nullptr ? std::vector{*only} : kernels_of(basis, each),
                      whitenings[s], innovations[s], {shape, places, s}, own);
            return own;
        };
        const auto finer = [&](Offer one, std::size_t places, bool as_smooth = false) {
            const Offer own = offer_of(one.shape, places, kFineLengths, as_smooth ? &one.kernel : nullptr);
            return own.score > one.score ? own : one;
        };
        // One covariate is as likely beforehand as two, and each table of its like, and each kernel of it.
        const auto price = [&](const std::vector<TableShape>& like, const Offer& one) {
            if (one.places == 0) return 0.0;
            const auto kernels = kernels_of(TableBasis(axes_, one.shape, one.places), kFineLengths);
            return std::log(2.0 * static_cast<double>(like.size() * kernels.size()));
        };
        const auto singles = single_shapes(subject_);
        std::vector<double> scores;
        for (const TableShape& shape : singles) {
            const Offer own = offer_of(shape, kPlacesOfOne, kCoarseLengths);
            scores.push_back(own.score);
            if (own.score > best.score) best = own;
        }
        if (best.places > 0) best = finer(best, kPlacesOfOne);
        const auto pairs = pair_shapes(subject_, leading(singles, scores, subject_.covariates.size()));
        Offer pair;
        for (const TableShape& shape : pairs) {
            const Offer own = offer_of(shape, kCoarsePlaces, kCoarseLengths);
            if (own.score > pair.score) pair = own;
        }
        if (pair.places > 0)
            pair = finer(finer(finer(pair, kCoarsePlaces), kFinePlaces), kFinestPlaces, true);
        best.score -= price(singles, best);
        pair.score -= price(pairs, pair);
        if (pair.score > best.score) best = pair;
        const double gain = best.score - base;
        if (!(gain > kClearly)) return false;
        parts_.push_back({TableBasis(axes_, best.shape, best.places), best.kernel, best.size});
        part_axes_.push_back(axes_of(best.shape, best.places));
        ErrorsLaw law = laws[best.setting];
        for (int round = 0; round < 2; ++round) {
            (void)fit_together(subject_, chosen_, law, error_, part_axes_, parts_);
            error_ = left_beside(subject_, chosen_, parts_);
            law = law_ = law_of(subject_.sums, error_, chosen_.known, chosen_.starts);
        }
        evidence_ += gain;
        return true;
    }

    Axes axes_of(const TableShape& shape, std::size_t places) {
        Axes axes;
        for (const std::size_t c : shape.over)
            axes.push_back(&axes_.axis(c, places));
        return axes;
    }

    std::size_t values() const {
        std::size_t sum = 0;
        for (const LearntPart& part : parts_)
            sum += part.basis.values() * part.basis.tables();
        return sum;
    }

    const Subject& subject_;
    const std::vector<char>& used_;
    LearningRows chosen_;
    std::vector<char> laid_;  // by which the places of tables are laid
    LaidAxes axes_{subject_, laid_};
    std::vector<Axes> part_axes_;
    ErrorsLaw law_;
    std::vector<double> error_;
    std::vector<LearntPart> parts_;
    double evidence_ = 0.0;
};

}  // namespace

std::vector<double> Learnt::in_rows(const Subject& subject) const {
    std::vector<double> added(subject.error.size(), 0.0);
    double sum = 0.0;
    for (std::size_t i = 0; i < added.size(); ++i) {
        double own = 0.0;
        for (const LearntPart& part : parts) {
            if (part.basis.shape().by_run) continue;
            const std::size_t table = part.basis.table_of(subject, i) * part.basis.values();
            part.basis.of_row(subject, i, [&](std::size_t value, double weight) {
                own += weight * part.value[static_cast<Index>(table + value)];
            });
        }
        sum = subject.sums ? (subject.starts[i] != 0 ? 0.0 : sum) + own : own;
        added[i] = sum;
    }
    return added;
}

Learnt learnt_from(const Subject& subject, const std::vector<char>& used) {
    return Learner(subject, used).learnt();
}

}  // namespace puckloop::gap

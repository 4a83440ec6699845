#include "gap/extension/formula.h"

#include "gap/extension/innovated.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

namespace puckloop::gap {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kMostSummands = 3;
constexpr double kAsWell = 3.0;      // nats: "not worth more than a bare mention" (Kass and Raftery 1995)
constexpr double kLeastOwn = 1e-10;  // share of a column's squares that earlier ones leave: else it is theirs

/// The moments of the rows that are looked at.
struct RowMoments {
    std::vector<std::size_t> all, end;  // and where each row's end among them

    RowMoments(const Subject& subject, const LearningRows& rows) {
        for (const std::size_t i : rows.row) {
            for (std::size_t m = subject.moments[i]; m < subject.moments[i + 1]; ++m)
                all.push_back(m);
            end.push_back(all.size());
        }
    }
};

/// An elementary function of the covariates, a value a moment.
struct Atom {
    std::string text;
    std::vector<double> value;
};

struct AtomForm {
    const char* text;
    double (*of)(double);
    bool positive_only;  ///< asked only where the covariate is above zero in every row
    bool of_angles;      ///< asked of angles only
};
constexpr AtomForm kForms[] = {{"{}", [](double x) { return x; }, false, false},
                               {"{}^2", [](double x) { return x * x; }, false, false},
                               {"{}^3", [](double x) { return x * x * x; }, false, false},
                               {"|{}|", [](double x) { return std::abs(x); }, false, false},
                               {"sqrt({})", [](double x) { return std::sqrt(x); }, true, false},
                               {"ln({})", [](double x) { return std::log(x); }, true, false},
                               {"1/{}", [](double x) { return 1 / x; }, true, false},
                               {"1/{}^2", [](double x) { return 1 / (x * x); }, true, false},
                               {"sin({})", [](double x) { return std::sin(x); }, false, true},
                               {"cos({})", [](double x) { return std::cos(x); }, false, true}};

std::vector<Atom> atoms_of_one(const WorldCovariate& covariate, const RowMoments& moments) {
    std::vector<Atom> atoms;
    bool positive = true, signs = false;
    for (const std::size_t m : moments.all) {
        positive = positive && covariate.value[m] > 0;
        signs = signs || covariate.value[m] < 0;
    }
    for (const AtomForm& form : kForms) {
        if ((form.positive_only && !positive) || (form.of_angles && covariate.unit != "rad")) continue;
        if (std::string_view(form.text) == "|{}|" && !signs) continue;
        Atom atom{fmt::format(fmt::runtime(form.text), covariate.name), {}};
        for (const std::size_t m : moments.all)
            atom.value.push_back(form.of(covariate.value[m]));
        atoms.push_back(std::move(atom));
    }
    return atoms;
}

Atom product(const Atom& a, const Atom& b) {
    Atom all{a.text + " x " + b.text, a.value};
    for (std::size_t k = 0; k < all.value.size(); ++k)
        all.value[k] *= b.value[k];
    return all;
}

/// Of what the tables are over.
std::vector<Atom> atoms_of(const Subject& subject, const LearningRows& rows, const RowMoments& moments,
                           const Learnt& learnt) {
    std::set<std::size_t> over;
    bool by_sensor = false;
    for (const LearntPart& part : learnt.parts) {
        const TableShape& shape = part.basis.shape();
        if (shape.by_run) continue;
        over.insert(shape.over.begin(), shape.over.end());
        if (shape.times >= 0) over.insert(static_cast<std::size_t>(shape.times));
        by_sensor = by_sensor || shape.by_sensor;
    }
    std::vector<Atom> atoms{{"1", std::vector<double>(moments.all.size(), 1.0)}};
    std::vector<std::vector<Atom>> single;
    for (const std::size_t c : over)
        single.push_back(atoms_of_one(subject.covariates[c], moments));
    for (std::size_t a = 0; a < single.size(); ++a) {
        atoms.insert(atoms.end(), single[a].begin(), single[a].end());
        for (std::size_t b = a + 1; b < single.size(); ++b)
            for (const Atom& one : single[a])
                for (const Atom& other : single[b])
                    atoms.push_back(product(one, other));
    }
    if (!by_sensor) return atoms;
    std::vector<Atom> all = atoms;
    for (int sensor = 0; sensor < subject.sensors; ++sensor)
        for (const Atom& one : atoms) {
            Atom own{fmt::format("{} (sensor {})", one.text, sensor), one.value};
            for (std::size_t k = 0, m = 0; k < rows.row.size(); ++k)
                for (; m < moments.end[k]; ++m)
                    if (subject.sensor[rows.row[k]] != sensor) own.value[m] = 0.0;
            all.push_back(std::move(own));
        }
    return all;
}

/// What the atom makes of the rows, as innovations times the root of their weights.
VectorXd column_of(const Subject& subject, const LearningRows& rows, const RowMoments& moments,
                   const Atom& atom, const Whitening& whitening, const VectorXd& weight) {
    std::vector<double> made(rows.row.size());
    double sum = 0.0;
    for (std::size_t k = 0, m = 0; k < made.size(); ++k) {
        double own = 0.0;
        for (; m < moments.end[k]; ++m)
            own += atom.value[m] * subject.weight[moments.all[m]];
        sum = subject.sums ? (rows.starts[k] != 0 ? 0.0 : sum) + own : own;
        made[k] = sum;
    }
    whitening.apply(made);
    return weight.cwiseSqrt().cwiseProduct(
        Eigen::Map<VectorXd>(made.data(), static_cast<Index>(made.size())));
}

std::string text_of(const std::vector<std::string>& texts, const VectorXd& factor) {
    std::string text;
    for (std::size_t k = 0; k < texts.size(); ++k) {
        const double value = factor[static_cast<Index>(k)];
        const std::string sign = value < 0 ? (text.empty() ? "-" : " - ") : (text.empty() ? "" : " + ");
        text += fmt::format("{}{:.3g}{}", sign, std::abs(value), texts[k] == "1" ? "" : " " + texts[k]);
    }
    return text;
}

}  // namespace

std::string formula_of(const Subject& subject, const std::vector<char>& used, const Learnt& learnt) {
    const LearningRows rows = learning_rows(subject, used, kRowsToFit);
    const Whitening whitening(learnt.law, rows.known, rows.starts);
    const auto without_runs = left_beside(subject, rows, learnt.parts, true);
    const Innovated left = innovated(rows, left_beside(subject, rows, learnt.parts), learnt.law, whitening);
    Innovated whole = innovated(rows, without_runs, learnt.law, whitening);
    const VectorXd target = left.weight.cwiseSqrt().cwiseProduct(whole.z);
    // Both by Akaike's criterion: what they fit less the numbers that they take to do it.
    const double tables = -left.rows / 2 * std::log(left.squares) - learnt.freedom;
    const RowMoments moments(subject, rows);
    const auto atoms = atoms_of(subject, rows, moments, learnt);
    std::vector<VectorXd> columns;
    for (const Atom& atom : atoms)
        columns.push_back(column_of(subject, rows, moments, atom, whitening, left.weight));
    // The next summand is the one that takes most of what is left; all factors are fitted anew.
    MatrixXd basis(target.size(), 0), chosen(target.size(), 0);
    std::vector<std::string> texts;
    VectorXd rest = target;
    while (texts.size() < kMostSummands) {
        double most = 0.0;
        std::size_t best = atoms.size();
        VectorXd next;
        for (std::size_t k = 0; k < atoms.size(); ++k) {
            const VectorXd own = columns[k] - basis * (basis.transpose() * columns[k]);
            const double squares = own.squaredNorm();
            if (!(squares > kLeastOwn * columns[k].squaredNorm())) continue;
            const double taken = std::pow(own.dot(rest), 2) / squares;
            if (taken > most) most = taken, best = k, next = own / std::sqrt(squares);
        }
        if (best == atoms.size()) return {};
        basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
        basis.col(basis.cols() - 1) = next;
        chosen.conservativeResize(Eigen::NoChange, chosen.cols() + 1);
        chosen.col(chosen.cols() - 1) = columns[best];
        texts.push_back(atoms[best].text);
        rest -= next * next.dot(rest);
        const double score = -left.rows / 2 * std::log(std::max(rest.squaredNorm(), 1e-300)) -
                             static_cast<double>(texts.size());
        if (score >= tables - kAsWell) return text_of(texts, chosen.colPivHouseholderQr().solve(target));
    }
    return {};
}

}  // namespace puckloop::gap

// muParser 2.3 keeps the values of its variables at addresses, and a copy of a parser costs 0.3 ms: so a
// formula keeps the parsers it has made, one for each thread that evaluated it at the same time. An
// evaluation costs some 0.3 to 0.7 us a row. Its bulk mode starts threads of its own and is not used.
//
// Refused before the library sees the text: assignments, which would write into variables, texts, and names
// that are neither variables nor functions, so that the nearest known name can be stated.

#include "gap/kinds/formula.h"

#include "base/text/suggest.h"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <numbers>
#include <utility>

namespace puckloop::gap {

namespace {

constexpr std::size_t kLongestName = 40;
constexpr const char* kFormulaRemedy = "a formula of docs/gap_kinds.md";

bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

using One = double (*)(double);
using Two = double (*)(double, double);
using Many = double (*)(const double*, int);

struct FunctionOfOne {
    const char* name;
    One function;
};
constexpr std::array<FunctionOfOne, 20> kOfOne{{
    {"abs", [](double x) { return std::abs(x); }},
    {"sqrt", [](double x) { return std::sqrt(x); }},
    {"exp", [](double x) { return std::exp(x); }},
    {"log", [](double x) { return std::log(x); }},
    {"log10", [](double x) { return std::log10(x); }},
    {"sin", [](double x) { return std::sin(x); }},
    {"cos", [](double x) { return std::cos(x); }},
    {"tan", [](double x) { return std::tan(x); }},
    {"asin", [](double x) { return std::asin(x); }},
    {"acos", [](double x) { return std::acos(x); }},
    {"atan", [](double x) { return std::atan(x); }},
    {"sinh", [](double x) { return std::sinh(x); }},
    {"cosh", [](double x) { return std::cosh(x); }},
    {"tanh", [](double x) { return std::tanh(x); }},
    {"floor", [](double x) { return std::floor(x); }},
    {"round", [](double x) { return std::round(x); }},
    {"step", [](double x) { return x < 0           ? 0.0
                                   : std::isnan(x) ? x
                                                   : 1.0; }},
    {"wrap", [](double x) { return std::remainder(x, 2 * std::numbers::pi); }},
    {"logistic", [](double x) { return 1 / (1 + std::exp(-x)); }},
    {"normal", [](double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }},
}};

struct FunctionOfTwo {
    const char* name;
    Two function;
};
constexpr std::array<FunctionOfTwo, 3> kOfTwo{{
    {"atan2", [](double y, double x) { return std::atan2(y, x); }},
    {"hypot", [](double x, double y) { return std::hypot(x, y); }},
    {"hyperbola", [](double x, double half) { return half / (half + x); }},
}};

double least_of(const double* values, int count) {
    return count < 1 ? NAN : *std::min_element(values, values + count);
}
double most_of(const double* values, int count) {
    return count < 1 ? NAN : *std::max_element(values, values + count);
}
double clipped_to(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

const std::vector<std::string_view>& function_names() {
    static const std::vector<std::string_view> names = [] {
        std::vector<std::string_view> all{"min", "max", "clip"};
        for (const auto& one : kOfOne)
            all.emplace_back(one.name);
        for (const auto& one : kOfTwo)
            all.emplace_back(one.name);
        return all;
    }();
    return names;
}

bool is_function(std::string_view name) {
    const auto& names = function_names();
    return std::ranges::find(names, name) != names.end();
}

/// Past the digits, point and exponent of a number that begins at `from`.
std::size_t end_of_number(std::string_view text, std::size_t from) {
    std::size_t at = from;
    while (at < text.size() && (is_digit(text[at]) || text[at] == '.'))
        ++at;
    if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
        std::size_t exponent = at + 1;
        if (exponent < text.size() && (text[exponent] == '+' || text[exponent] == '-')) ++exponent;
        if (exponent < text.size() && is_digit(text[exponent])) {
            at = exponent;
            while (at < text.size() && is_digit(text[at]))
                ++at;
        }
    }
    return at;
}

/// A comparison's sign may hold '=', nothing else.
void refuse_assignment(std::string_view text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '=') continue;
        const bool closes = i > 0 && std::string_view("<>!=").find(text[i - 1]) != std::string_view::npos;
        const bool opens = i + 1 < text.size() && text[i + 1] == '=';
        if (opens) ++i;
        if (!closes && !opens)
            throw FormulaError(fmt::format("has \"=\" at character {}", i + 1),
                               "== to compare; a formula sets nothing");
    }
}

/// The names in the text, and nothing that is no part of a formula. Indices of variables, each once, rising.
std::vector<std::size_t> names_in(std::string_view text, const std::vector<std::string>& variables) {
    std::vector<std::size_t> used;
    for (std::size_t at = 0; at < text.size();) {
        const char c = text[at];
        if (is_digit(c) || c == '.') {
            const std::size_t end = end_of_number(text, at);
            if (end < text.size() && is_letter(text[end]))
                throw FormulaError(
                    fmt::format("has \"{}\" right after a number at character {}", text[end], end + 1),
                    "an operator between the two");
            at = end;
        } else if (is_letter(c)) {
            std::size_t end = at;
            while (end < text.size() && (is_letter(text[end]) || is_digit(text[end])))
                ++end;
            const std::string_view name = text.substr(at, end - at);
            const auto next = text.find_first_not_of(" \t", end);
            const bool called = next != std::string_view::npos && text[next] == '(';
            const auto place = std::ranges::find(variables, name);
            if (called && !is_function(name))
                throw FormulaError(fmt::format("calls \"{}\" at character {}, which is no function{}", name,
                                               at + 1, did_you_mean(name, function_names())),
                                   fmt::format("one of {}", fmt::join(function_names(), " ")));
            if (!called && is_function(name))
                throw FormulaError(
                    fmt::format("has the function {} without \"(\" at character {}", name, at + 1),
                    kFormulaRemedy);
            if (!called && name != "pi") {
                if (place == variables.end()) {
                    const std::vector<std::string_view> known(variables.begin(), variables.end());
                    throw FormulaError(
                        fmt::format("has \"{}\" at character {}, which is no column, parameter "
                                    "or formula of this kind{}",
                                    name, at + 1, did_you_mean(name, known)),
                        kFormulaRemedy);
                }
                used.push_back(static_cast<std::size_t>(place - variables.begin()));
            }
            at = end;
        } else if (std::string_view(" \t+-*/^<>=!&|?:(),").find(c) == std::string_view::npos) {
            const bool printable = c > 0x20 && c < 0x7f;
            throw FormulaError(printable ? fmt::format("has \"{}\" at character {}", c, at + 1)
                                         : fmt::format("has no text at character {}", at + 1),
                               kFormulaRemedy);
        } else {
            ++at;
        }
    }
    std::ranges::sort(used);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    return used;
}

/// Our functions and no others.
void define_functions(mu::Parser& parser) {
    parser.ClearFun();
    parser.ClearConst();
    parser.ClearPostfixOprt();
    parser.DefineConst("pi", std::numbers::pi);
    for (const auto& one : kOfOne)
        parser.DefineFun(one.name, one.function);
    for (const auto& one : kOfTwo)
        parser.DefineFun(one.name, one.function);
    parser.DefineFun("min", static_cast<Many>(least_of));
    parser.DefineFun("max", static_cast<Many>(most_of));
    parser.DefineFun("clip", clipped_to);
}

/// A parser with the places its variables are at.
struct Evaluator {
    mu::Parser parser;
    std::vector<double> values;

    Evaluator(const std::string& text, const std::vector<std::string>& names) : values(names.size(), 1.0) {
        define_functions(parser);
        for (std::size_t i = 0; i < names.size(); ++i)
            parser.DefineVar(names[i], &values[i]);
        parser.SetExpr(text);
        (void)parser.Eval();  // parses it
    }
    Evaluator(const Evaluator&) = delete;
    Evaluator& operator=(const Evaluator&) = delete;
};

[[noreturn]] void refuse_text(const mu::Parser::exception_type& error) {
    std::string message = error.GetMsg();
    while (!message.empty() && (message.back() == '.' || message.back() == '!'))
        message.pop_back();
    std::ranges::replace_if(
        message, [](char c) { return c < 0x20 || c > 0x7e; }, ' ');
    throw FormulaError("is no formula: " + message, kFormulaRemedy);
}

}  // namespace

bool is_variable_name(std::string_view name) {
    if (name.empty() || name.size() > kLongestName || !is_letter(name.front()) || name.front() == '_')
        return false;
    if (name == "pi" || is_function(name)) return false;
    return std::ranges::all_of(name, [](char c) { return is_letter(c) || is_digit(c); });
}

class Formula::Pool {
  public:
    Pool(const std::string& text, std::vector<std::string> names) : text_(text), names_(std::move(names)) {
        idle_.push_back(std::make_unique<Evaluator>(text_, names_));
        if (idle_.front()->parser.GetNumResults() != 1)
            throw FormulaError("has several values, with commas between them", "one value");
    }
    std::unique_ptr<Evaluator> take() {
        {
            const std::lock_guard lock(mutex_);
            if (!idle_.empty()) {
                auto one = std::move(idle_.back());
                idle_.pop_back();
                return one;
            }
        }
        return std::make_unique<Evaluator>(text_, names_);
    }
    void give_back(std::unique_ptr<Evaluator> one) {
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(one));
    }

  private:
    std::string text_;
    std::vector<std::string> names_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<Evaluator>> idle_;
};

Formula::Formula(std::string text, const std::vector<std::string>& variables) : text_(std::move(text)) {
    if (text_.find_first_not_of(" \t") == std::string::npos) throw FormulaError("is empty", kFormulaRemedy);
    if (text_.size() > kLongest)
        throw FormulaError(fmt::format("has {} characters", text_.size()),
                           fmt::format("at most {}; parts of it as formulas of their own", kLongest));
    refuse_assignment(text_);
    used_ = names_in(text_, variables);
    std::vector<std::string> names;
    for (const std::size_t index : used_)
        names.push_back(variables[index]);
    try {
        pool_ = std::make_unique<Pool>(text_, std::move(names));
    } catch (const mu::Parser::exception_type& error) {
        refuse_text(error);
    }
}

Formula::~Formula() = default;
Formula::Formula(Formula&&) noexcept = default;
Formula& Formula::operator=(Formula&&) noexcept = default;

void Formula::evaluate(std::span<const Input> inputs, std::span<double> out) const {
    auto evaluator = pool_->take();
    for (std::size_t k = 0; k < inputs.size(); ++k)
        if (inputs[k].rows == nullptr) evaluator->values[k] = inputs[k].value;
    for (std::size_t i = 0; i < out.size(); ++i) {
        for (std::size_t k = 0; k < inputs.size(); ++k)
            if (inputs[k].rows != nullptr) evaluator->values[k] = inputs[k].rows[i];
        out[i] = evaluator->parser.Eval();
    }
    pool_->give_back(std::move(evaluator));
}

}  // namespace puckloop::gap

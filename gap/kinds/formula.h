#pragma once
// A formula of named variables, as the user of a described kind writes it: muParser's syntax with a list of
// functions of our own, so that what a formula means does not depend on the library's release.
//
//     + - * / ^    < <= > >= == !=    && ||    condition ? a : b    pi
//     abs sqrt exp log (natural) log10 sin cos tan asin acos atan atan2 sinh cosh tanh floor round hypot
//     min max (any number of arguments)    step(x): 0 below 0, else 1    clip(x, low, high)
//     wrap(angle): into -pi to pi    logistic(x): 1 / (1 + exp(-x))    normal(x): share of a normal
//     distribution below x    hyperbola(x, half): half / (half + x)

#include <cstddef>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap {

/// Why a text is no formula; who reads the file adds its name and the line.
class FormulaError : public std::runtime_error {
  public:
    FormulaError(const std::string& problem, std::string expected)
        : std::runtime_error(problem), expected_(std::move(expected)) {}
    const std::string& expected() const { return expected_; }

  private:
    std::string expected_;
};

/// A letter, then letters, digits and underscores, at most 40; no function's name and not "pi".
bool is_variable_name(std::string_view name);

class Formula {
  public:
    static constexpr std::size_t kLongest = 2000;  ///< characters

    /// Names in `variables` may stand in it. FormulaError with what is wrong and where in the text.
    Formula(std::string text, const std::vector<std::string>& variables);
    ~Formula();
    Formula(Formula&&) noexcept;
    Formula& operator=(Formula&&) noexcept;

    const std::string& text() const { return text_; }
    /// Indices in `variables` of those that it has, rising.
    const std::vector<std::size_t>& used() const { return used_; }

    /// One variable over rows: a value for each of them, or the same in all.
    struct Input {
        const double* rows = nullptr;
        double value = 0.0;  ///< where `rows` is nullptr
    };
    /// Its value in each row of `out`; `inputs` in the order of used(). What is not defined gives NaN or an
    /// infinity. May run on several threads at a time; the same inputs give the same bits.
    void evaluate(std::span<const Input> inputs, std::span<double> out) const;

  private:
    class Pool;
    std::string text_;
    std::vector<std::size_t> used_;
    std::unique_ptr<Pool> pool_;
};

}  // namespace puckloop::gap

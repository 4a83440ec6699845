#pragma once
// The integers of a compiler whose int has 16 bits, as C++ classes: the firmware's own C sources, compiled
// for the host as C++ with these in place of types.h, calculate as on the robot. What C leaves undefined
// there (overflow of a signed value, a shift too far, division by zero) is reported by fail(). Shifting a
// negative value left is not: the firmware's compilers define it.
//
// A host's int in an expression is a literal or an enumerator: it counts as the target's int, or, from 0x8000
// to 0xFFFF beside an unsigned operand, as its unsigned int. One that fits neither is reported, too.

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace hosted {

/// An access to a volatile variable: time passes, interrupts may come.
void touch();
/// Prints what is wrong with the two values, and where, and ends the program as a sanitizer does.
[[noreturn]] void fail(const char* what, long long a, long long b);

template <class T>
class Int;

/// What of an operand's type counts; `type` is the target's.
template <class X>
struct Operand {
    static constexpr bool kIs = std::is_arithmetic_v<X> || std::is_enum_v<X>;
    static constexpr bool kClass = false;
    static constexpr bool kLiteral = std::same_as<X, int> || std::same_as<X, unsigned>;
    using type = std::conditional_t<
        std::same_as<X, unsigned long>, std::uint32_t,
        std::conditional_t<std::same_as<X, long>, std::int32_t,
                           std::conditional_t<std::same_as<X, unsigned>, std::uint16_t, std::int16_t>>>;
};
template <class T>
struct Operand<Int<T>> {
    static constexpr bool kIs = true, kClass = true, kLiteral = false;
    using type = T;
};
template <class X>
using Plain = std::remove_cv_t<X>;
template <class X>
concept AnOperand = Operand<Plain<X>>::kIs;
template <class X>
concept AClass = Operand<Plain<X>>::kClass;
template <class X>
using TargetType = typename Operand<Plain<X>>::type;

/// Integer promotion: what is narrower than int becomes int.
template <class T>
using Promoted = std::conditional_t<sizeof(T) == 1, std::int16_t, T>;
template <class A, class B>
using Common = std::conditional_t<
    std::same_as<Promoted<A>, std::uint32_t> || std::same_as<Promoted<B>, std::uint32_t>, std::uint32_t,
    std::conditional_t<sizeof(A) == 4 || sizeof(B) == 4, std::int32_t,
                       std::conditional_t<std::same_as<A, std::uint16_t> || std::same_as<B, std::uint16_t>,
                                          std::uint16_t, std::int16_t>>>;

/// The value of an operand; of a volatile one at a volatile access.
template <AnOperand X>
constexpr auto get(const X& x) {
    if constexpr (AClass<X>)
        return x.read();
    else
        return x;
}

/// An operand as `C`, the type in which the target calculates.
template <class C, AnOperand X>
constexpr C as(const X& x) {
    const auto value = get(x);
    if constexpr (Operand<Plain<X>>::kLiteral) {
        constexpr bool kSigned = std::same_as<C, std::int16_t>;
        constexpr int kLowest = kSigned ? -0x8000 : -0x10000, kHighest = kSigned ? 0x7FFF : 0xFFFF;
        const int wide = static_cast<int>(value);  // ~ of an unsigned literal is below -0x8000 here
        if (sizeof(C) == 2 && (wide < kLowest || wide > kHighest))
            fail("a literal that is no int of 16 bits", wide, 0);
    }
    return static_cast<C>(value);
}

template <class C>
constexpr C add(C a, C b) {
    C sum{};
    if (__builtin_add_overflow(a, b, &sum) && std::is_signed_v<C>) fail("signed overflow: a + b", a, b);
    return sum;
}
template <class C>
constexpr C subtract(C a, C b) {
    C difference{};
    if (__builtin_sub_overflow(a, b, &difference) && std::is_signed_v<C>)
        fail("signed overflow: a - b", a, b);
    return difference;
}
template <class C>
constexpr C multiply(C a, C b) {
    C product{};
    if (__builtin_mul_overflow(a, b, &product) && std::is_signed_v<C>) fail("signed overflow: a * b", a, b);
    return product;
}
template <class C>
constexpr void check_divisor(C a, C b) {
    if (b == 0) fail("division by zero: a / b", a, b);
    if constexpr (std::is_signed_v<C>)
        if (b == -1 && a == std::numeric_limits<C>::min()) fail("signed overflow: a / b", a, b);
}
template <class C>
constexpr int checked_shift(C a, long long count) {
    if (count < 0 || count >= static_cast<long long>(sizeof(C) * 8)) fail("shift too far: a by b", a, count);
    return static_cast<int>(count);
}

// NOLINTBEGIN: macros write the operators, which are all alike.
#define HOSTED_BINARY(op, expression)                                                                        \
    template <AnOperand A, AnOperand B>                                                                      \
    requires(AClass<A> || AClass<B>) constexpr auto operator op(const A& left, const B& right) {             \
        using C = Common<TargetType<A>, TargetType<B>>;                                                      \
        const C a = as<C>(left);                                                                             \
        const C b = as<C>(right);                                                                            \
        return Int<C>(static_cast<C>(expression));                                                           \
    }
HOSTED_BINARY(+, add<C>(a, b))
HOSTED_BINARY(-, subtract<C>(a, b))
HOSTED_BINARY(*, multiply<C>(a, b))
HOSTED_BINARY(/, (check_divisor<C>(a, b), a / b))
HOSTED_BINARY(%, (check_divisor<C>(a, b), a % b))
HOSTED_BINARY(&, a& b)
HOSTED_BINARY(|, a | b)
HOSTED_BINARY(^, a ^ b)
#undef HOSTED_BINARY

#define HOSTED_COMPARISON(op)                                                                                \
    template <AnOperand A, AnOperand B>                                                                      \
    requires(AClass<A> || AClass<B>) constexpr bool operator op(const A& left, const B& right) {             \
        using C = Common<TargetType<A>, TargetType<B>>;                                                      \
        const C a = as<C>(left);                                                                             \
        const C b = as<C>(right);                                                                            \
        return a op b;                                                                                       \
    }
HOSTED_COMPARISON(==)
HOSTED_COMPARISON(!=)
HOSTED_COMPARISON(<)
HOSTED_COMPARISON(<=)
HOSTED_COMPARISON(>)
HOSTED_COMPARISON(>=)
#undef HOSTED_COMPARISON

/// Shifts have the left operand's type.
template <AnOperand A, AnOperand B>
requires(AClass<A> || AClass<B>) constexpr auto operator<<(const A& left, const B& right) {
    using C = Promoted<TargetType<A>>;
    const C a = as<C>(left);
    const int count = checked_shift<C>(a, static_cast<long long>(get(right)));
    return Int<C>(static_cast<C>(static_cast<std::uint64_t>(static_cast<std::int64_t>(a)) << count));
}
template <AnOperand A, AnOperand B>
requires(AClass<A> || AClass<B>) constexpr auto operator>>(const A& left, const B& right) {
    using C = Promoted<TargetType<A>>;
    const C a = as<C>(left);
    const int count = checked_shift<C>(a, static_cast<long long>(get(right)));
    return Int<C>(static_cast<C>(a >> count));
}
template <AClass A>
constexpr auto operator-(const A& x) {
    using C = Promoted<TargetType<A>>;
    return Int<C>(subtract<C>(0, as<C>(x)));
}
template <AClass A>
constexpr auto operator+(const A& x) {
    using C = Promoted<TargetType<A>>;
    return Int<C>(as<C>(x));
}
template <AClass A>
constexpr auto operator~(const A& x) {
    using C = Promoted<TargetType<A>>;
    return Int<C>(static_cast<C>(~as<C>(x)));
}

/// As wide as T, trivial, so that structures and unions of them are laid out as they are on the target.
template <class T>
class Int {
  public:
    Int() = default;
    /// Any operand, truncated, as C converts. (What copies structures is the compiler's own.)
    template <class X>
    requires AnOperand<std::remove_reference_t<X>>
    constexpr Int(X&& x) : value_(static_cast<T>(get(x))) {}

    constexpr T read() const { return value_; }
    T read() const volatile {
        touch();
        return value_;
    }

    template <AnOperand X>
    Int& operator=(const X& x) {
        value_ = static_cast<T>(get(x));
        return *this;
    }
    template <AnOperand X>
    Int operator=(const X& x) volatile {
        const auto value = static_cast<T>(get(x));
        touch();
        value_ = value;
        return Int(value);
    }

#define HOSTED_ASSIGNMENT(op)                                                                                \
    template <AnOperand X>                                                                                   \
    Int& operator op##=(const X& x) {                                                                        \
        return *this = *this op x;                                                                           \
    }                                                                                                        \
    template <AnOperand X>                                                                                   \
    Int operator op##=(const X& x) volatile {                                                                \
        return *this = *this op x;                                                                           \
    }
    HOSTED_ASSIGNMENT(+)
    HOSTED_ASSIGNMENT(-)
    HOSTED_ASSIGNMENT(*)
    HOSTED_ASSIGNMENT(/)
    HOSTED_ASSIGNMENT(%)
    HOSTED_ASSIGNMENT(&)
    HOSTED_ASSIGNMENT(|)
    HOSTED_ASSIGNMENT(^)
    HOSTED_ASSIGNMENT(<<)
    HOSTED_ASSIGNMENT(>>)
#undef HOSTED_ASSIGNMENT

#define HOSTED_STEP(op, by)                                                                                  \
    Int& operator op() {                                                                                     \
        return *this = *this by 1;                                                                           \
    }                                                                                                        \
    Int operator op() volatile {                                                                             \
        return *this = *this by 1;                                                                           \
    }                                                                                                        \
    Int operator op(int) {                                                                                   \
        const Int was = *this;                                                                               \
        *this = was by 1;                                                                                    \
        return was;                                                                                          \
    }                                                                                                        \
    Int operator op(int) volatile {                                                                          \
        const Int was = *this;                                                                               \
        *this = was by 1;                                                                                    \
        return was;                                                                                          \
    }
    HOSTED_STEP(++, +)
    HOSTED_STEP(--, -)
#undef HOSTED_STEP

    constexpr explicit operator bool() const {
        return value_ != 0;
    }
    explicit operator bool() const volatile {
        return read() != 0;
    }
    /// To long, which subscripts take, and to char, and only as a template: `condition ? Int : literal` stays
    /// an Int.
    template <class L>
    requires(std::same_as<L, long> || std::same_as<L, char>) constexpr operator L() const {
        return static_cast<L>(value_);
    }
    template <std::same_as<long> L>
    operator L() const volatile {
        return static_cast<long>(read());
    }
    template <class U>
    requires(std::is_arithmetic_v<U> && !std::same_as<U, bool> && !std::same_as<U, long> &&
             !std::same_as<U, char>) constexpr explicit
    operator U() const {
        return static_cast<U>(value_);
    }

  private:
    T value_;
};
// NOLINTEND

/// What `switch` looks at.
template <AClass A>
constexpr long long switched(const A& x) {
    return get(x);
}
template <class E>
requires(!AClass<E>) constexpr E switched(E x) {
    return x;
}

/// The pic30 compiler's division of 32 by 16 bits, one processor instruction: the quotient has to fit.
template <AnOperand A, AnOperand B>
Int<std::uint16_t> divide_32_by_16(const A& left, const B& right) {
    const auto a = static_cast<std::uint32_t>(get(left));
    const auto b = static_cast<std::uint16_t>(get(right));
    if (b == 0) fail("division by zero: a / b", a, b);
    if (a / b > 0xFFFF) fail("quotient of more than 16 bits: a / b", a, b);
    return a / b;
}

}  // namespace hosted

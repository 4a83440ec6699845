// The target's integers against C's rules for an int of 16 bits, written down once more with wide arithmetic.

#include "base/random.h"
#include "firmware/host/integers.h"

#include <catch2/catch.hpp>

#include <functional>
#include <stdexcept>
#include <string>

namespace {

using puckloop::RandomStream;
int touches = 0;

struct Failed : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace

namespace hosted {
void touch() {
    ++touches;
}
void fail(const char* what, long long, long long) {
    throw Failed(what);
}
}  // namespace hosted

namespace {

using u8 = hosted::Int<unsigned char>;
using s8 = hosted::Int<signed char>;
using u16 = hosted::Int<unsigned short>;
using s16 = hosted::Int<short>;
using u32 = hosted::Int<unsigned int>;
using s32 = hosted::Int<int>;

/// A type of the target's: its width, and whether it has a sign.
struct Type {
    int bits;
    bool has_sign;
    long long lowest() const { return has_sign ? -(1ll << (bits - 1)) : 0; }
    long long highest() const { return has_sign ? (1ll << (bits - 1)) - 1 : (1ll << bits) - 1; }
    bool holds(long long value) const { return value >= lowest() && value <= highest(); }
    long long wrap(long long value) const {
        const long long low = value & ((1ll << bits) - 1);
        return has_sign && low > highest() ? low - (1ll << bits) : low;
    }
};
template <class I>
constexpr Type kType{};
template <class T>
constexpr Type kType<hosted::Int<T>>{static_cast<int>(sizeof(T) * 8), std::is_signed_v<T>};

Type promoted(Type type) {
    return type.bits < 16 ? Type{16, true} : type;
}
/// The usual arithmetic conversions.
Type common(Type a, Type b) {
    a = promoted(a);
    b = promoted(b);
    if (a.bits != b.bits) return a.bits > b.bits ? a : b;
    return a.has_sign ? b : a;
}

long long drawn(RandomStream& random, Type type) {
    const auto bits = static_cast<long long>(random.next());
    switch (bits >> 60 & 3) {
    case 0:
        return type.wrap(bits & 7);
    case 1:
        return type.wrap(type.highest() - (bits & 3));
    case 2:
        return type.wrap(type.lowest() + (bits & 3));
    default:
        return type.wrap(bits);
    }
}

/// What an operation gives, or that it must fail.
struct Wanted {
    bool fails;
    long long value;
};
template <class I>
void check(const Wanted& wanted, const std::function<I()>& operation) {
    bool failed = false;
    long long value = 0;
    try {
        value = static_cast<long long>(operation().read());
    } catch (const Failed&) {
        failed = true;
    }
    REQUIRE(failed == wanted.fails);
    if (!failed) REQUIRE(value == wanted.value);
}
Wanted within(Type type, long long value) {
    if (type.has_sign && !type.holds(value)) return {true, 0};
    return {false, type.wrap(value)};
}

template <class A, class B>
void compare(RandomStream& random) {
    const Type wide = common(kType<A>, kType<B>);
    for (int i = 0; i < 300; ++i) {
        const long long left = drawn(random, kType<A>), right = drawn(random, kType<B>);
        INFO(left << " and " << right << " of " << kType<A>.bits << " and " << kType<B>.bits << " bits");
        const A a(static_cast<long>(left));
        const B b(static_cast<long>(right));
        const long long x = wide.wrap(left), y = wide.wrap(right);
        using C = decltype(a + b);
        REQUIRE(kType<C>.bits == wide.bits);
        REQUIRE(kType<C>.has_sign == wide.has_sign);
        check<C>(within(wide, x + y), [&] { return a + b; });
        check<C>(within(wide, x - y), [&] { return a - b; });
        check<C>(within(wide, wide.has_sign ? x * y
                                            : static_cast<long long>(static_cast<unsigned long long>(x) *
                                                                     static_cast<unsigned long long>(y))),
                 [&] { return a * b; });
        const bool undefined = y == 0 || (wide.has_sign && x == wide.lowest() && y == -1);
        check<C>({undefined, undefined ? 0 : x / y}, [&] { return a / b; });
        check<C>({undefined, undefined ? 0 : x % y}, [&] { return a % b; });
        check<C>({false, wide.wrap(x & y)}, [&] { return a & b; });
        check<C>({false, wide.wrap(x | y)}, [&] { return a | b; });
        check<C>({false, wide.wrap(x ^ y)}, [&] { return a ^ b; });
        REQUIRE((a < b) == (x < y));
        REQUIRE((a >= b) == (x >= y));
        REQUIRE((a == b) == (x == y));

        const Type alone = promoted(kType<A>);
        using P = decltype(a << b);
        const bool too_far = right < 0 || right >= alone.bits;
        check<P>({too_far, too_far ? 0
                                   : alone.wrap(static_cast<long long>(static_cast<unsigned long long>(left)
                                                                       << right))},
                 [&] { return a << b; });
        check<P>({too_far, too_far ? 0 : alone.wrap(left >> right)}, [&] { return a >> b; });
        check<P>(within(alone, -left), [&] { return -a; });
        check<P>({false, alone.wrap(~left)}, [&] { return ~a; });

        A into = a;
        into = b;
        REQUIRE(static_cast<long long>(into.read()) == kType<A>.wrap(right));
    }
}

}  // namespace

TEST_CASE("arithmetic of an int of 16 bits") {
    RandomStream random(Catch::rngSeed(), "hosted integers");
    compare<u8, u8>(random);
    compare<u8, s16>(random);
    compare<s8, u16>(random);
    compare<u16, u8>(random);
    compare<u16, u16>(random);
    compare<s16, s16>(random);
    compare<s16, u16>(random);
    compare<u32, u16>(random);
    compare<s16, s32>(random);
    compare<s32, s32>(random);
    compare<u16, s32>(random);
    compare<s32, u32>(random);
}

TEST_CASE("literals beside them are of 16 bits, too") {
    const u16 late = 0x0003, early = 0xFFFE;
    CHECK((late - early).read() == 5);  // across the wrap
    CHECK(late - early >= 5);
    CHECK(s16(-1) < 1);
    CHECK(u16(0xFFFF) == 0xFFFF);
    CHECK((u16(0xFFFF) & ~0xC0D3).read() == 0x3F2C);
    CHECK_THROWS_AS(s16(1) + 0x8000, Failed);  // the target's int does not hold it
    CHECK_THROWS_AS(u16(1) + 0x12345, Failed);
    CHECK_THROWS_AS(s16(0x7FFF) + 1, Failed);
    CHECK((u16(0xFFFF) + 1).read() == 0);
    CHECK_THROWS_AS(hosted::divide_32_by_16(u32(0x10000), u16(1)), Failed);
    CHECK(hosted::divide_32_by_16(u32(0xFFFF0), u16(0x10)).read() == 0xFFFF);
}

TEST_CASE("each access to a volatile variable lets time pass") {
    volatile u8 shared = 3;
    touches = 0;
    const u8 read = shared;
    CHECK(touches == 1);
    shared |= 4;  // read and written
    CHECK(touches == 3);
    CHECK(shared++ == 7);
    CHECK(touches == 5);
    CHECK(read.read() == 3);
    CHECK(static_cast<bool>(shared));
}

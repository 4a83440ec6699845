#include "tests/avr/random_c.h"

#include <fmt/format.h>

namespace puckloop::avr::test {

namespace {

constexpr int kTypes = 8, kUnsigned = 4;
// Unsigned first: arithmetic is done unsigned, where it wraps, and converted.
constexpr const char* kType[kTypes] = {"uint8_t", "uint16_t", "uint32_t", "uint64_t",
                                       "int8_t",  "int16_t",  "int32_t",  "int64_t"};
constexpr int kBits[kTypes] = {8, 16, 32, 64, 8, 16, 32, 64};

constexpr const char* kHead = R"(
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <math.h>
char output[6000];
volatile uint16_t output_length;
static uint32_t hash = 2166136261u;
__attribute__((noinline)) static void put(char c) { if (output_length < sizeof output) output[output_length++] = c; }
__attribute__((noinline)) static void mix(uint64_t value) {
    for (uint8_t i = 0; i < 8; ++i) { hash = (hash ^ (uint8_t)value) * 16777619u; value >>= 8; }
}
__attribute__((noinline)) static void show(void) {
    for (int8_t i = 28; i >= 0; i -= 4) put("0123456789abcdef"[hash >> i & 15]);
    put('\n');
}
static void mix_real(float f) { uint32_t bits; memcpy(&bits, &f, 4); mix((bits & 0x7F800000) == 0x7F800000 ? 1 : bits); }
struct Pack { uint8_t a : 3; int8_t b : 5; uint16_t c; int32_t d; uint8_t e[5]; };
static struct Pack packs[4];
static volatile uint8_t v8; static volatile uint16_t v16; static volatile uint32_t v32;
static float reals[4] = {1.5f, -0.25f, 1000.0f, 3.1415927f};
__attribute__((noinline)) void finished(void) { for (;;) __asm__ volatile(""); }
)";

}  // namespace

std::string RandomC::literal(int type) {
    static constexpr std::uint64_t kEdges[] = {0,      1,      2,          3,          7,         8,
                                               10,     0x7F,   0x80,       0xFF,       0x100,     0x7FFF,
                                               0x8000, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF};
    std::uint64_t value = below(3) ? kEdges[below(17)] : random_.next();
    if (kBits[type] < 64) value &= (std::uint64_t{1} << kBits[type]) - 1;
    return fmt::format("(({}){}ull)", kType[type], value);
}

std::string RandomC::variable(int type) {
    switch (below(7)) {
    case 0:
        return fmt::format("({})v{}", kType[type], 8 << below(3));
    case 1:
        return fmt::format("({})packs[{}].{}", kType[type], below(4),
                           std::string("abcd").substr(static_cast<std::size_t>(below(4)), 1));
    case 2:
        return fmt::format("({})table{}[({}) % 16]", kType[type], below(kTypes), "(uint8_t)hash");
    default:
        if (variables_.empty()) return literal(type);
        return fmt::format(
            "({}){}", kType[type],
            variables_[static_cast<std::size_t>(below(static_cast<int>(variables_.size())))].name);
    }
}

std::string RandomC::expression(int type, int depth) {
    if (depth <= 0) return below(3) ? variable(type) : literal(type);
    const int u = type % kUnsigned;  // wraps where the signed one must not
    const auto sub = [&](int t) { return expression(t, depth - 1 - below(2)); };
    const std::string a = fmt::format("({})({})", kType[u], sub(type));
    switch (below(14)) {
    case 0:
    case 1:
        return fmt::format("({})({} + ({}){})", kType[type], a, kType[u], sub(type));
    case 2:
        return fmt::format("({})({} - ({}){})", kType[type], a, kType[u], sub(type));
    case 3:
        return fmt::format("({})((uint32_t){} * (uint32_t){})", kType[type], a, sub(below(kTypes)));
    case 4:
        return fmt::format("({})((uint64_t){} * (uint64_t){})", kType[type], a, sub(below(kTypes)));
    case 5:
        return fmt::format("({})({} / (({})({}) | 1))", kType[type], a, kType[u], sub(type));
    case 6:
        return fmt::format("({})({} % (({})({}) | 1))", kType[type], a, kType[u], sub(type));
    case 7: {  // a signed division whose divisor is small and not -1
        const int s = kUnsigned + below(kUnsigned);
        return fmt::format("({})(({})({}) / {})", kType[type], kType[s], sub(s), 2 + below(100));
    }
    case 8:
        return fmt::format("({})({} << (({}) & {}))", kType[type], a, sub(0),
                           kBits[u] == 64   ? 63
                           : kBits[u] == 32 ? 31
                                            : 7);
    case 9: {
        const int s = below(kTypes);
        return fmt::format("({})(({})({}) >> (({}) & {}))", kType[type], kType[s], sub(s), sub(0),
                           kBits[s] - 1);
    }
    case 10:
        return fmt::format("({})({} {} {})", kType[type], a, below(2) ? "&" : "^", sub(type));
    case 11:
        return fmt::format("({})({} | {})", kType[type], a, sub(type));
    case 12:
        return fmt::format("({} ? {} : {})", condition(depth - 1), sub(type), sub(type));
    default:
        if (functions_ == 0) return fmt::format("({})~{}", kType[type], a);
        return fmt::format("({})f{}({}, {}, depth)", kType[type], below(functions_), sub(1), sub(6));
    }
}

std::string RandomC::real(int depth) {
    if (depth <= 0) switch (below(3)) {
        case 0:
            return fmt::format("reals[{}]", below(4));
        case 1:
            return fmt::format("{}.{}f", below(200), below(1000));
        default:
            return fmt::format("(float)({})", variable(below(kTypes)));
        }
    const auto sub = [&] { return real(depth - 1); };
    switch (below(9)) {
    case 0:
        return fmt::format("({} + {})", sub(), sub());
    case 1:
        return fmt::format("({} - {})", sub(), sub());
    case 2:
        return fmt::format("({} * {})", sub(), sub());
    case 3:
        return fmt::format("({} / (fabsf({}) + 0.5f))", sub(), sub());
    case 4:
        return fmt::format("sqrtf(fabsf({}))", sub());
    case 5:
        return fmt::format("sinf({})", sub());
    case 6:
        return fmt::format("(float)((int16_t)fmodf({}, 1000.0f))", sub());
    case 7:
        return fmt::format("({} ? {} : {})", condition(1), sub(), sub());
    default:
        return fmt::format("floorf({})", sub());
    }
}

std::string RandomC::condition(int depth) {
    static constexpr const char* kCompare[] = {"<", "<=", ">", ">=", "==", "!="};
    const int type = below(kTypes);
    return fmt::format("({} {} {})", expression(type, depth), kCompare[below(6)], expression(type, depth));
}

std::string RandomC::assignment() {
    switch (below(9)) {
    case 0:
        return fmt::format("v{} = {};\n", 8 << below(3), expression(2, 2));
    case 1:
        return fmt::format("packs[{}].{} = {};\n", below(4),
                           std::string("abcd").substr(static_cast<std::size_t>(below(4)), 1),
                           expression(1, 2));
    case 2:
        return fmt::format("packs[{}].e[({}) % 5] += (uint8_t){};\n", below(4), expression(0, 1),
                           expression(0, 2));
    case 3: {
        const int t = below(kTypes);
        return fmt::format("table{}[({}) % 16] = {};\n", t, expression(0, 1), expression(t, 3));
    }
    case 4:
        return fmt::format("reals[{}] = {};\nif (!(fabsf(reals[0]) < 1e6f)) reals[0] = 1.0f;\n", below(4),
                           real(2));
    case 5:
        return fmt::format("mix({});\n", expression(3, 3));
    case 6:
        return fmt::format("mix_real({});\n", real(2));
    default: {
        if (variables_.empty()) return "mix(1);\n";
        const Variable& v = variables_[static_cast<std::size_t>(below(static_cast<int>(variables_.size())))];
        return fmt::format("{} = {};\n", v.name, expression(v.type, 3));
    }
    }
}

std::string RandomC::statement(int depth) {
    if (depth <= 0) return assignment();
    switch (below(8)) {
    case 0:
        return fmt::format("if {} {{\n{}}} else {{\n{}}}\n", condition(2), block(depth - 1, 2),
                           block(depth - 1, 1));
    case 1: {
        const int n = loops_++;
        return fmt::format("for (uint8_t i{0} = 0; i{0} < {1}; ++i{0}) {{\nmix(i{0});\n{2}}}\n", n,
                           1 + below(4), block(depth - 1, 2));
    }
    case 2: {
        std::string text = fmt::format("switch ((uint8_t){} % 9) {{\n", expression(0, 2));
        for (int i = 0; i < 9; i += 1 + below(2))
            text += fmt::format("case {}: {}{}", i, assignment(), below(4) ? "break;\n" : "/* on */\n");
        return text + fmt::format("default: {}}}\n", assignment());
    }
    case 3: {
        const int n = loops_++;
        return fmt::format("{{ int16_t n{0} = {1}; do {{\n{2}n{0} -= {3};\n}} while (n{0} > 0); }}\n", n,
                           1 + below(30), block(depth - 1, 1), 7 + below(9));
    }
    case 4:
        return fmt::format("memmove(packs[{}].e, packs[{}].e, {});\n", below(4), below(4), below(6));
    default:
        return assignment();
    }
}

std::string RandomC::block(int depth, int statements) {
    std::string text;
    for (int i = 0; i < statements; ++i)
        text += statement(depth);
    return text;
}

std::string RandomC::function(int number) {
    variables_.clear();
    variables_.push_back({"a", 1});
    variables_.push_back({"b", 6});
    std::string locals;
    for (int i = 0; i < 2 + below(4); ++i) {
        const int type = below(kTypes);
        locals += fmt::format("{} x{} = {};\n", kType[type], i, expression(type, 1));
        variables_.push_back({fmt::format("x{}", i), type});
    }
    std::string text =
        fmt::format("__attribute__((noinline)) static {} f{}(uint16_t a, int32_t b, uint8_t depth) {{\n",
                    kType[below(kTypes)], number);
    text += "if (depth++ > 3) return 1;\n" + locals + block(2, 2 + below(3));
    if (below(3) == 0) text += fmt::format("if (a & 1) b = (int32_t)f{}(a >> 1, b, depth);\n", number);
    return text + fmt::format("return {};\n}}\n", expression(1, 2));
}

std::string RandomC::program() {
    std::string text = kHead;
    for (int t = 0; t < kTypes; ++t) {
        text += fmt::format("static {} table{}[16] = {{", kType[t], t);
        for (int i = 0; i < 16; ++i)
            text += literal(t) + ",";
        text += "};\n";
    }
    const int functions = 2 + below(4);
    for (int i = 0; i < functions; ++i) {
        text += function(i);
        functions_ = i + 1;
    }
    variables_.clear();
    text += "int main(void) {\nuint8_t depth = 0;\n(void)depth;\n";
    for (int i = 0; i < 8; ++i)
        text += block(2, 2) + "show();\n";
    text += "for (uint8_t i = 0; i < 16; ++i) {";
    for (int t = 0; t < kTypes; ++t)
        text += fmt::format("mix((uint64_t)table{}[i]);", t);
    return text + "}\nshow();\nfinished();\n}\n";
}

}  // namespace puckloop::avr::test

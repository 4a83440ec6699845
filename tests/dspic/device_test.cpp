// The register and interrupt tables hold together: order, uniqueness, fields inside the implemented bits.

#include "emu/dspic/devices/device.h"
#include "emu/dspic/devices/dspic30f6014a_irq.h"
#include "emu/dspic/devices/dspic33fj256gp710_irq.h"
#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/machine/sfr_space.h"

#include <catch2/catch.hpp>

#include <charconv>
#include <set>
#include <string>

using namespace puckloop::dspic;

namespace {

// "TCKPS:5:4" or "TON:15" -> mask of the field's bits.
std::uint16_t field_mask(std::string_view field) {
    const std::size_t first = field.find(':');
    const std::size_t second = field.find(':', first + 1);
    int high = 0;
    int low = 0;
    std::from_chars(field.data() + first + 1, field.data() + field.size(), high);
    low = high;
    if (second != std::string_view::npos)
        std::from_chars(field.data() + second + 1, field.data() + field.size(), low);
    REQUIRE(high >= low);
    REQUIRE(high < 16);
    return static_cast<std::uint16_t>(((1u << (high - low + 1)) - 1u) << low);
}

}  // namespace

TEST_CASE("registers are in address order, named once, and their fields fill their implemented bits") {
    const DeviceInfo& device = *GENERATE(from_range(devices().begin(), devices().end()));
    INFO(device.name);
    std::set<std::string_view> names;
    int last = -2;
    for (const RegisterInfo& info : device.registers) {
        INFO(info.name);
        CHECK(info.address % 2 == 0);
        CHECK(info.address > last);
        CHECK(info.address < 0x800);
        last = info.address;
        CHECK(names.insert(info.name).second);
        if (info.fields.empty()) continue;
        unsigned bits = 0;
        for (std::size_t at = 0; at < info.fields.size();) {
            const std::size_t end = std::min(info.fields.find(' ', at), info.fields.size());
            const unsigned field = field_mask(info.fields.substr(at, end - at));
            CHECK((bits & field) == 0);
            bits |= field;
            at = end + 1;
        }
        CHECK(bits == info.implemented);
    }
    CHECK(names.size() == (device.family_33f ? 416 : 350));
}

TEST_CASE("interrupts are in order and their priority fields exist with reset value 4") {
    const DeviceInfo& device = *GENERATE(from_range(devices().begin(), devices().end()));
    INFO(device.name);
    int last = -1;
    SfrSpace sfr;
    sfr.describe(device.registers);
    for (const IrqName& info : device.irqs) {
        INFO(info.name);
        CHECK(info.irq > last);
        last = info.irq;
        const auto ipc = static_cast<std::uint16_t>(device.ipc + info.irq / 4 * 2);
        CHECK((sfr.raw(ipc) >> (info.irq % 4 * 4) & 7) == 4);
        CHECK(sfr.info(ipc)->fields.find(info.priority) != std::string_view::npos);
        for (const auto& [bank, name] :
             {std::pair(device.ifs, info.flag), std::pair(device.iec, info.enable)}) {
            const auto address = static_cast<std::uint16_t>(bank + info.irq / 16 * 2);
            REQUIRE(sfr.info(address) != nullptr);
            CHECK((sfr.info(address)->implemented >> (info.irq % 16) & 1) == 1);
            CHECK(sfr.info(address)->fields.find(name) != std::string_view::npos);
        }
    }
    CHECK(device.irqs.size() == (device.family_33f ? 63 : 41));
    CHECK(irq::U2RX == 24);
    CHECK(irq33::U2RX == 30);
}

TEST_CASE("devices are found by command-line name, vectors by number") {
    CHECK(find_device("dspic30f6014a") == &dspic30f6014a());
    CHECK(find_device("dspic33fj256gp710") == &dspic33fj256gp710());
    CHECK(find_device("dspic30f9999") == nullptr);
    CHECK(device_names() == "dspic30f6014a, dspic33fj256gp710");
    CHECK(dspic30f6014a().irq("U2RX") == 24);
    CHECK_FALSE(dspic30f6014a().irq("DMA0"));
    CHECK(dspic30f6014a().vector_name(4) == "MathError");
    CHECK(dspic30f6014a().vector_name(8 + 24) == "U2RX");
    CHECK(dspic30f6014a().vector_name(8 + 39) == "Reserved");
    CHECK(dspic33fj256gp710().irq("DMA0") == 4);
    CHECK_FALSE(dspic33fj256gp710().irq("NVM"));
    CHECK(dspic33fj256gp710().vector_name(5) == "DmacError");
    CHECK(dspic33fj256gp710().vector_name(8 + 16) == "SI2C1");
}

TEST_CASE("bits of registers come from the device tables") {
    constexpr RegisterBits kTxCON{"T?CON"};
    STATIC_REQUIRE(kTxCON["TON"] == 0x8000);
    STATIC_REQUIRE(kTxCON["TCKPS"] == 0x0030);
    STATIC_REQUIRE(kTxCON["TCKPS"].of(0xFFEF) == 2);
    STATIC_REQUIRE(RegisterBits{"I2C*STAT"}["R_W"] == 0x0004);      // the 33FJ's name
    STATIC_REQUIRE(RegisterBits{"I2C*STAT"}["R_NOT_W"] == 0x0004);  // the 30F's
    STATIC_REQUIRE((RegisterBits{"INTCON1"}["MATHERR"] | RegisterBits{"INTCON1"}["OSCFAIL"]) == 0x0012);
    STATIC_REQUIRE(name_fits("*SIDL", "TSIDL"));
    STATIC_REQUIRE_FALSE(name_fits("T?CON", "T10CON"));
    // Every field lies within its register, and no two share a bit.
    for (const DeviceInfo* device : devices())
        for (const RegisterInfo& info : device->registers) {
            std::uint16_t seen = 0;
            for_fields(info, [&](const RegisterField& field) {
                INFO(device->name << " " << info.name << " " << field.name);
                CHECK(field.mask != 0);
                CHECK((field.mask & seen) == 0);
                CHECK(field_mask(info, field.name) == field.mask);
                seen |= field.mask;
            });
        }
}

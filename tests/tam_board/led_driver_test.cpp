// The LED driver register by register: data sheet SLDS157.
#include "emu/tam_avr/led_driver.h"

#include <catch2/catch.hpp>

#include <initializer_list>

using puckloop::tam::LedDriver;

namespace {

constexpr std::uint8_t kWrite = LedDriver::kAddress << 1, kRead = kWrite | 1;

/// START, address, bytes, STOP; the outputs that changed.
std::uint16_t send(LedDriver& driver, std::initializer_list<std::uint8_t> bytes,
                   std::uint8_t address = kWrite) {
    REQUIRE(driver.start(address));
    for (const std::uint8_t byte : bytes)
        REQUIRE(driver.write(byte));
    return driver.stop();
}

}  // namespace

TEST_CASE("the LED driver is dark and asleep after a reset") {
    LedDriver driver;
    CHECK(driver.register_value(0x00) == 0x11);
    CHECK(driver.register_value(0x12) == 0xFF);
    CHECK(send(driver, {0x14, 0x55}) == 0);  // on, but the oscillator is off
    CHECK(send(driver, {0x00, 0x01}) == 0x000F);
    CHECK(driver.duty(0) == 1.0);
    CHECK(driver.duty(4) == 0.0);
}

TEST_CASE("an LED is off, on, dimmed, or dimmed with its group") {
    LedDriver driver;
    send(driver, {0x00, 0x01});
    CHECK(send(driver, {0x14, 0b11'10'01'00}) == 0b0010);  // the dimmed ones are at brightness 0
    CHECK(send(driver, {0x04, 0x40}) == 0b0100);
    CHECK(send(driver, {0x05, 0x80}) == 0b1000);
    CHECK(driver.duty(2) == 0.25);
    CHECK(driver.duty(3) == 0.5 * 255 / 256);
    CHECK(send(driver, {0x12, 0x80}) == 0b1000);
    CHECK(driver.duty(3) == 0.25);
}

TEST_CASE("outputs follow at the STOP, and register numbers advance as asked") {
    LedDriver driver;
    send(driver, {0x00, 0x01});
    REQUIRE(driver.start(kWrite));
    for (const int byte : {0x80 | 0x14, 0xAA, 0xAA, 0xAA, 0xAA})
        REQUIRE(driver.write(static_cast<std::uint8_t>(byte)));
    for (int led = 0; led < 16; ++led)
        CHECK(driver.duty(led) == 0.0);
    driver.stop();
    // Brightness only: behind 11 comes 02.
    CHECK(send(driver, {0xA0 | 0x11, 0x10, 0x20}) == 0x8001);
    CHECK(driver.duty(15) == 16.0 / 256);
    CHECK(driver.duty(0) == 32.0 / 256);
    // Read back, all registers: behind the last comes 00.
    send(driver, {0x80 | 0x1C});
    REQUIRE(driver.start(kRead));
    CHECK(driver.read() == 0xFF);
    CHECK(driver.read() == 0x00);
    CHECK(driver.read() == 0x00);
    CHECK(driver.read() == 0x01);
    driver.stop();
}

TEST_CASE("the LED driver answers its addresses and no other, and resets by call") {
    LedDriver driver;
    CHECK_FALSE(driver.start(0x61 << 1));
    CHECK(driver.start(0x68 << 1));  // the call to all
    driver.stop();
    send(driver, {0x00, 0x01});
    CHECK(send(driver, {0x14, 0x01}) == 1);
    // A software reset is A5 5A at 6B, and nothing else.
    REQUIRE(driver.start(0x6B << 1));
    CHECK(driver.write(0xA5));
    CHECK_FALSE(driver.write(0xA5));
    driver.stop();
    CHECK(driver.duty(0) == 1.0);
    CHECK(send(driver, {0xA5, 0x5A}, 0x6B << 1) == 1);
    CHECK(driver.duty(0) == 0.0);
    CHECK(driver.register_value(0x00) == 0x11);
    // Registers behind the last, and the error flags, refuse what is written.
    REQUIRE(driver.start(kWrite));
    CHECK(driver.write(0x1F));
    CHECK_FALSE(driver.write(0x00));
}

#pragma once
// An AVR on the bench: what the bare chip and the boards around one share. USART0 and USART1 are the bench's
// uart1 and uart2.

#include "bench/targets/target.h"
#include "emu/avr/chip/chip.h"

#include <array>
#include <utility>

namespace puckloop::exec {

class AvrTarget : public Target {
  public:
    /// `fuses`: as TargetOptions has them.
    AvrTarget(const avr::DeviceInfo& device, const std::vector<std::uint8_t>& fuses, TargetListener& listener)
        : device_(device), fuses_(fuses), listener_(listener) {}

    image::Image read_image(const std::string& file, std::string_view mcu) override;
    void uart_receive(int unit, const cosim::UartFrame& frame) override {
        avr().uart_receive(unit - 1, frame);
    }
    bool is_i2c_slave() const override { return false; }
    void i2c_slave_phase(const cosim::I2cPhase&) override {}
    cosim::Time earliest_i2c_answer() const override { return cosim::kNever; }

    const cosim::ClockDomain& clock() override { return avr().clock(); }
    cosim::Time now() override { return avr().now(); }
    std::uint32_t pc() override { return avr().pc(); }
    void stop_at(std::uint32_t pc) override { avr().stop_at(pc); }
    bool stopped() override { return avr().stopped_at().has_value(); }
    bool uart_enabled(int unit) override { return avr().uart_listens(unit - 1); }
    dspic::UartCounters uart_counters(int unit) override { return avr().uart_counters(unit - 1); }
    std::size_t resets() override { return avr().report().resets.size(); }
    std::string chip_json() override;
    std::string chip_text() override;
    std::vector<std::string> warnings() override;
    std::optional<std::string> hang() override { return avr().hang(); }
    std::string source_line(std::uint32_t pc) const override { return firmware_.lines.at(pc); }
    std::vector<std::uint32_t> addresses_of(std::string_view file, std::uint32_t line) const override {
        return firmware_.lines.addresses(file, line);
    }
    const image::LineTable& lines() const override { return firmware_.lines; }
    void reset_button() override { avr().external_reset(); }
    void load_kept(const image::Image& image, const board::NvmFile& nvm) override;
    void save_memory(board::NvmFile& nvm) override;

    std::unique_ptr<debug::DebugChip> debug_chip() override;

  protected:
    virtual avr::Chip& avr() = 0;
    /// The image that read_image() read.
    const image::AvrImage& firmware() const { return firmware_; }
    TargetListener& listener() { return listener_; }
    /// The listener gets a line for each pin that changed; `function_of` names what it is for, or "".
    void show_pins(avr::PortLetter port, std::uint8_t levels, std::uint8_t driven, cosim::Time now,
                   std::string_view (*function_of)(avr::PortLetter port, int bit));

    static constexpr int kPorts = 4;

  private:
    double seconds(avr::Cycle cycle);

    void use_fuses();

    const avr::DeviceInfo& device_;
    std::vector<std::uint8_t> fuses_;
    TargetListener& listener_;
    std::array<std::pair<std::uint8_t, std::uint8_t>, kPorts> shown_{};  ///< levels, driven
    image::AvrImage firmware_;
};

}  // namespace puckloop::exec

#pragma once
// Special function registers as C++ objects: every access goes to the emulated chip's peripherals.

#include "firmware/host/integers.h"

#include <cstdint>

namespace hosted {

/// An access of the CPU to its data space, and the time it takes. Interrupts may come before it, and routines
/// of the firmware's run then.
std::uint16_t read_word(std::uint16_t address);
void write_word(std::uint16_t address, std::uint16_t value);
std::uint8_t read_byte(std::uint16_t address);
void write_byte(std::uint16_t address, std::uint8_t value);
/// Between these two no time passes: what the CPU does to a register in one instruction.
void begin_instruction();
void end_instruction();

template <class T>
T read_register(std::uint16_t address) {
    if constexpr (sizeof(T) == 1)
        return read_byte(address);
    else
        return read_word(address);
}
template <class T>
void write_register(std::uint16_t address, T value) {
    if constexpr (sizeof(T) == 1)
        write_byte(address, value);
    else
        write_word(address, value);
}

template <class T>
class Register;
template <class T>
struct Operand<Register<T>> {
    static constexpr bool kIs = true, kClass = true, kLiteral = false;
    using type = T;
};

/// What & of a register gives: registers that follow it.
template <class T>
struct RegisterAddress {
    std::uint16_t address;
    Register<T> operator[](long index) const;
};

template <class T>
class Register {
  public:
    constexpr explicit Register(std::uint16_t address) : address_(address) {}

    T read() const volatile { return read_register<T>(address_); }
    RegisterAddress<T> operator&() const volatile { return {address_}; }

    // NOLINTBEGIN
    template <AnOperand X>
    Int<T> operator=(const X& x) const volatile {
        const auto value = static_cast<T>(get(x));
        write_register<T>(address_, value);
        return value;
    }
    Int<T> operator=(const Register& other) const volatile { return *this = Int<T>(other); }
#define HOSTED_ASSIGNMENT(op)                                                                                \
    template <AnOperand X>                                                                                   \
    Int<T> operator op##=(const X& x) const volatile {                                                       \
        const auto right = get(x);                                                                           \
        Update update(address_);                                                                             \
        const Int<T> value = Int<T>(read()) op right;                                                        \
        write_register<T>(address_, value.read());                                                           \
        return value;                                                                                        \
    }
    HOSTED_ASSIGNMENT(+)
    HOSTED_ASSIGNMENT(-)
    HOSTED_ASSIGNMENT(&)
    HOSTED_ASSIGNMENT(|)
    HOSTED_ASSIGNMENT(^)
#undef HOSTED_ASSIGNMENT
    explicit operator bool() const volatile {
        return read() != 0;
    }
    template <std::same_as<long> L>
    operator L() const volatile {
        return static_cast<long>(read());
    }
    // NOLINTEND

  private:
    /// Read, change and write back. The dsPIC has instructions for it, on all that this firmware has to do
    /// with; the AVR on its first 32 I/O registers.
    class Update {
      public:
        explicit Update(std::uint16_t address) : whole_(sizeof(T) == 2 || address < kFirstWithout) {
            if (whole_) begin_instruction();
        }
        ~Update() {
            if (whole_) end_instruction();
        }
        Update(const Update&) = delete;
        Update& operator=(const Update&) = delete;

      private:
        static constexpr std::uint16_t kFirstWithout = 0x40;
        bool whole_;
    };
    std::uint16_t address_;
};

template <class T>
Register<T> RegisterAddress<T>::operator[](long index) const {
    return Register<T>(static_cast<std::uint16_t>(address + index * static_cast<long>(sizeof(T))));
}

/// A register in an expression that may throw its value away, as `(void)SPI1BUF;` does: then it is read at
/// the end.
template <class T>
class Discardable {
  public:
    explicit Discardable(const volatile Register<T>& source) : source_(source) {}
    Discardable(const Discardable&) = delete;
    Discardable& operator=(const Discardable&) = delete;
    ~Discardable() noexcept(false) {
        if (!used_) source_.read();
    }
    T read() const {
        used_ = true;
        return source_.read();
    }
    template <AnOperand X>
    void operator=(const X& x) {  // NOLINT
        used_ = true;
        source_ = x;
    }

  private:
    const volatile Register<T>& source_;
    mutable bool used_ = false;
};
template <class T>
struct Operand<Discardable<T>> : Operand<Register<T>> {};
template <class T>
Discardable<T> discardable(const volatile Register<T>& source) {
    return Discardable<T>(source);
}

}  // namespace hosted

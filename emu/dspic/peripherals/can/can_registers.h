#pragma once
// Distances of a CAN module's registers from CxRXF0SID, and their bits.

#include "emu/dspic/devices/register_bits.h"

namespace puckloop::dspic::can {

enum Offset : int {
    kFilter = 0x00,  ///< SID, EIDH, EIDL; the next filter eight bytes on
    kMask = 0x30,
    kFilterStep = 8,
    kTx = 0x60,  ///< TX0: SID, EID, DLC, four data words, CON; the next buffer 16 bytes before
    kRx = 0x80,  ///< RX0 alike
    kBufferStep = -16,
    kData = 6,
    kBufferCon = 14,
    kCtrl = 0x90,
    kCfg1 = 0x92,
    kCfg2 = 0x94,
    kIntf = 0x96,
    kInte = 0x98,
    kEc = 0x9A
};

inline constexpr RegisterBits kCTRL{"C?CTRL"};
inline constexpr RegisterBits kCFG1{"C1CFG1"};
inline constexpr RegisterBits kCFG2{"C1CFG2"};
inline constexpr RegisterBits kTXCON{"C?TX?CON"};
inline constexpr RegisterBits kTXSID{"C?TX?SID"};
inline constexpr RegisterBits kTXEID{"C?TX?EID"};
inline constexpr RegisterBits kTXDLC{"C?TX?DLC"};
inline constexpr RegisterBits kRXSID{"C?RX?SID"};
inline constexpr RegisterBits kRXDLC{"C?RX?DLC"};
inline constexpr RegisterBits kRX0CON{"C?RX0CON"};
inline constexpr RegisterBits kRX1CON{"C?RX1CON"};

/// CxINTF: the flags of the receive and transmit buffers follow each other.
inline constexpr std::uint16_t kRx0If = 1, kTx0If = 4, kErrIf = 0x20, kWakIf = 0x40, kIvrIf = 0x80;
inline constexpr std::uint16_t kEwarn = 0x100, kRxWarn = 0x200, kTxWarn = 0x400, kRxBp = 0x800;
inline constexpr std::uint16_t kTxBp = 0x1000, kTxBo = 0x2000, kRx1Ovr = 0x4000, kRx0Ovr = 0x8000;

}  // namespace puckloop::dspic::can

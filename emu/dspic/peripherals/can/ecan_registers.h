#pragma once
// Distances of an ECAN module's registers from CxCTRL1, and their bits.

#include "emu/dspic/devices/register_bits.h"

namespace puckloop::dspic::ecan {

enum Offset : int {
    kCtrl1 = 0x00,
    kCtrl2 = 0x02,
    kVec = 0x04,
    kFctrl = 0x06,
    kFifo = 0x08,
    kIntf = 0x0A,
    kInte = 0x0C,
    kEc = 0x0E,
    kCfg1 = 0x10,
    kCfg2 = 0x12,
    kFen1 = 0x14,
    kFmskSel1 = 0x18,
    kFmskSel2 = 0x1A,
    kWindow = 0x20,  ///< from here on CxCTRL1.WIN chooses
    kWindowEnd = 0x80,
    // WIN = 0
    kRxFul1 = 0x20,
    kRxOvf1 = 0x28,
    kTr01Con = 0x30,
    kRxD = 0x40,
    kTxD = 0x42,
    // WIN = 1
    kBufPnt1 = 0x20,
    kMask = 0x30,    ///< SID, EID; the next four bytes on
    kFilter = 0x40,  ///< alike
};

inline constexpr RegisterBits kCTRL1{"C1CTRL1"};
inline constexpr RegisterBits kVEC{"C1VEC"};
inline constexpr RegisterBits kFCTRL{"C1FCTRL"};
inline constexpr RegisterBits kFIFO{"C1FIFO"};
inline constexpr RegisterBits kINTF{"C1INTF"};
inline constexpr RegisterBits kRXMSID{"C1RXM0SID"};
inline constexpr RegisterBits kRXFSID{"C1RXF1SID"};

}  // namespace puckloop::dspic::ecan

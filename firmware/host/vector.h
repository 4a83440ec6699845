#pragma once

namespace hosted {

/// A routine for an interrupt vector, counted in the order of the vector table: the dsPIC's from the first
/// trap's on, the AVR's from reset's.
struct Vector {
    int number;
    void (*routine)();
};

}  // namespace hosted

// The registers that the firmware names, defined: dspic_c.h is included before this line.

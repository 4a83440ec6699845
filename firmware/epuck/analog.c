#include "analog.h"

#include "accelerometer.h"
#include "board.h"
#include "ircom.h"
#include "microphones.h"
#include "proximity.h"

#define SCANNED (MICROPHONES | ACCELEROMETER | PHOTOTRANSISTORS)

/* A scan is 14 channels of (1 TAD sampling + 14 TAD conversion) of 10 cycles each: 2100 cycles. The next scan
 * writes over the first result 150 cycles after the interrupt, so the lowest channels are fetched first. */
void INTERRUPT _ADCInterrupt(void) {
    IFS0 &= ~ADIF;
    microphones_scanned();
    accelerometer_scanned();
#ifdef IRCOM
    ircom_scanned();
#endif
    proximity_scanned();
}

void analog_start(void) {
    ADPCFG = ~SCANNED; /* 0 = analogue */
    ADCSSL = SCANNED;
    ADCHS = 0;
    ADCON2 = CSCNA | SMPI(CHANNELS);
    ADCON3 = SAMC(1) | ADCS(20); /* TAD = 10 cycles = 678 ns */
    IFS0 &= ~ADIF;
    IPC2 = (IPC2 & ~IP_MASK(ADIP)) | ADIP(LEVEL_ADC);
    IEC0 |= ADIF;
    ADCON1 = ADON | SSRC_AUTO | ASAM;
}

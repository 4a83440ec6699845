/* Reads and writes registers of an I2C device by SMBus calls, as Python's smbus does, in the order of its
 * arguments: smbus_registers DEVICE ADDRESS ROUNDS STEP... A STEP is "b:3" or "w:3" (reads a byte or a word
 * of register 3 and prints it), "b:3=7" or "w:3=-200" (writes it), or "ms:20" (waits). A line for each round;
 * "error N" for a step that fails. A ten-bit ADDRESS is ten:0x2a5. */
#include <errno.h>
#include <fcntl.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

static void step(int file, const char* what) {
    if (strncmp(what, "ms:", 3) == 0) {
        usleep((unsigned)atoi(what + 3) * 1000);
        return;
    }
    const char* value = strchr(what, '=');
    union i2c_smbus_data data;
    memset(&data, 0, sizeof data);
    if (value && what[0] == 'w') data.word = (unsigned short)atoi(value + 1);
    if (value && what[0] == 'b') data.byte = (unsigned char)atoi(value + 1);
    struct i2c_smbus_ioctl_data call = {value ? I2C_SMBUS_WRITE : I2C_SMBUS_READ,
                                        (unsigned char)strtol(what + 2, NULL, 0),
                                        what[0] == 'w' ? I2C_SMBUS_WORD_DATA : I2C_SMBUS_BYTE_DATA, &data};
    if (ioctl(file, I2C_SMBUS, &call) < 0)
        printf("error %d ", errno);
    else if (!value)
        printf("%s=%d ", what, what[0] == 'w' ? (short)data.word : data.byte);
}

int main(int count, char** words) {
    if (count < 5) return 2;
    const int file = open(words[1], O_RDWR);
    const char* address = words[2];
    if (strncmp(address, "ten:", 4) == 0) {
        if (file < 0 || ioctl(file, I2C_TENBIT, 1) < 0) return 1;
        address += 4;
    }
    if (file < 0 || ioctl(file, I2C_SLAVE, strtol(address, NULL, 0)) < 0) return 1;
    for (int rounds = atoi(words[3]); rounds > 0; --rounds) {
        for (int i = 4; i < count; ++i)
            step(file, words[i]);
        printf("\n");
    }
    return 0;
}

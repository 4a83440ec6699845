#include "tools/guide/image_catalogue.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace puckloop::tools {

namespace {

// Repositories and paths: commit 4cb85cb33e8c of gctronic/e-puck-library, 66cb8d9b4112 of
// demiurge-project/argos3-epuck; each file was compared with the repository's own, bit by bit. Boot times
// are from runs: BTcom's to its first byte, ARGoS' to the first wake-up that is answered.
constexpr std::string_view kLibrary = "gctronic/e-puck-library", kArgos = "demiurge-project/argos3-epuck";
constexpr std::string_view kSercom = "puckloop exec IMAGE --uart1 pty --realtime";
constexpr std::string_view kDemo = "puckloop exec IMAGE --selector 2 --uart1 - --seconds 20";
constexpr std::string_view kRabCommand = "puckloop run own_rab.toml --firmware rab=IMAGE";
constexpr std::string_view kLoader = "puckloop exec IMAGE --nvm robot0.nvm --uart1 pty --realtime";

constexpr std::array kImages{
    CataloguedImage{"BTcom_default.hex", kLibrary, "program/BTcom/BTcom_default.hex",
                    "6495b1bbcafb48866000789e2db3218aeb68d540bbde719e15f7c5b75040eb0c", "pic", "1.2 s",
                    "sercom protocol at UART1 and over Bluetooth: sensors, motors, camera", kSercom},
    CataloguedImage{"BTcom_floor_sensor.hex", kLibrary, "program/BTcom/BTcom_floor_sensor.hex",
                    "e034be49314d0c2b21b12379048ef994ae81ac5922851ac1b3e8272cb7de0856", "pic", "1.2 s",
                    "the same with floor sensors", kSercom},
    CataloguedImage{"BTcom_floor_lis_sesnor_turret.hex", kLibrary,
                    "program/BTcom/BTcom_floor_lis_sesnor_turret.hex",
                    "3e7668a00dc556acad762b76020eda1117969ae35f49bccc5732302c54845805", "pic", "1.2 s",
                    "the same with floor sensors and a listening turret", kSercom},
    CataloguedImage{"BTcom_20_LIS_rev84.hex", kLibrary, "tool/ePic/Firmware/BTcom_20_LIS_rev84.hex",
                    "16618614f8251ef9889f31390996d92ec9044fb4792f742737a06b8167ad00d6", "pic", "1.4 s",
                    "sercom 2.0, as the ePic toolbox wants it", kSercom},
    CataloguedImage{"Demo.hex", kLibrary, "program/demo/Demo.hex",
                    "41ac801050dd9ca6b5d715c3f9c022604c9095d9618d2390bea595a5e1c56aa6", "pic", "",
                    "sixteen demonstrations, chosen by the selector", kDemo},
    CataloguedImage{"Demo-default.hex", kLibrary, "program/demo/Demo-default.hex",
                    "2fe1fb4e5b39af9bd81c3f41a620665633ba2a227ba278dd4406a6f24bbd3a4d", "pic", "",
                    "the same, as robots were delivered", kDemo},
    CataloguedImage{
        "demoGCtronic.X.production.hex", kLibrary,
        "program/DemoGCtronic-complete/demoGCtronic.X/dist/default/production/demoGCtronic.X.production.hex",
        "89921d3f2f1fb7848c03360aa6278c238671563378845edb12641c1c58043342", "pic", "",
        "GCtronic's demonstrations, chosen by the selector; revisions 1.2 and 1.3", kDemo},
    CataloguedImage{
        "demoGCtronic.X.production.elf", kLibrary,
        "program/DemoGCtronic-complete/demoGCtronic.X/dist/default/production/demoGCtronic.X.production.elf",
        "97da124873498bca91e69ff00c8b2ec66f6609b1df98aa85f96da0a27fca3973", "pic", "",
        "the same with symbols and source lines", kDemo},
    CataloguedImage{"demoGCtronic-rev117+bootloader.hex", kLibrary,
                    "program/DemoGCtronic-complete/demoGCtronic-rev117+bootloader.hex",
                    "70adb06d98f51cb74d8a2e030797692f4b924593f6410ff5019abbce0fba3920", "pic", "",
                    "the same behind a boot loader", kDemo},
    CataloguedImage{"demoGCtronic-rev117+bootloader+EEPROM-FFF7.hex", kLibrary,
                    "program/DemoGCtronic-complete/demoGCtronic-rev117+bootloader+EEPROM-FFF7.hex",
                    "dd910b56ab6ecb1a4a6c2a56f7aae24975232335d8ef8ab31c072bee0b248372", "pic", "",
                    "the same with an EEPROM", kDemo},
    CataloguedImage{"bluetoot_mirror.hex", kLibrary, "program/bluetooth_mirror/bluetoot_mirror.hex",
                    "67456bb6a631e9c6ce69e5546a1cb1588d75e016db003678df319d36cf977b11", "pic", "",
                    "bytes from UART1 to UART2 and back", kSercom},
    CataloguedImage{"tinybld_ds6014A_7.37Mhz_115200uart1_8xPLL_with_LEDs.hex", kLibrary,
                    "tool/bootloader/epuck_side/tinybld_ds6014A_7.37Mhz_115200uart1_8xPLL_with_LEDs.hex",
                    "56861cf98f2e30b3fa90b569152255bf94ef6c62599ff7881229a047305b3a44", "pic", "",
                    "boot loader at UART1", kLoader},
    CataloguedImage{
        "tinybld_ds6014A_7.37Mhz_115200uart1_8xPLL_with_LEDs_helper.hex", kLibrary,
        "tool/bootloader/epuck_side/tinybld_ds6014A_7.37Mhz_115200uart1_8xPLL_with_LEDs_helper.hex",
        "41da142ea10b1024e0cb911a5bd8bac4c1e76c7708ba7c939ac11d6ff00ba21c", "pic", "",
        "uploads that boot loader", kLoader},
    CataloguedImage{"tinybld_ds6014A_7.37Mhz_115200uart2_8xPLL_with_LEDs.hex", kLibrary,
                    "tool/bootloader/epuck_side/tinybld_ds6014A_7.37Mhz_115200uart2_8xPLL_with_LEDs.hex",
                    "16b6461a49782f3f00d578b7810869aa2465f6f67352ad3614ff51cabb5a7f9a", "pic", "",
                    "boot loader at UART2", "puckloop exec IMAGE --nvm robot0.nvm --uart2 pty --realtime"},
    CataloguedImage{"epuck_firmware.hex", kArgos, "firmware/uploader-linux-libbluetooth/epuck_firmware.hex",
                    "c3e284b63685bfdb3010ef2657e666d369746070820df24d5ffe1090feb64e84", "pic", "39.5 s",
                    "ARGoS' firmware for robots with a Linux board",
                    "puckloop run own_binaries.toml --firmware pic=IMAGE --linux ./controller"},
    CataloguedImage{"randb.hex", kArgos, "erab_firmware/e-RandB_firmware_parametric/randb.hex",
                    "2e2e72251e9af4d9139ef7d2e4db0df7ef7f5ccbadbfd7f400d817b40aaa88b9", "rab", "",
                    "range and bearing, frames of a size that is set", kRabCommand},
    CataloguedImage{"randb.cof", kArgos, "erab_firmware/e-RandB_firmware_parametric/randb.cof",
                    "bda7ea16f3a8ec6c59cfe7b3c4a9e2317bdff53db2206cf780b2dc24d170e159", "rab", "",
                    "the same with symbols and source lines", kRabCommand},
    CataloguedImage{"erab_1to4b.hex", kArgos, "erab_firmware/erab_1to4b.hex",
                    "e266763fdf360c0a98a2d0dcd1b34d73edb2ad1ed9c9dc3e6cda475eac330836", "rab", "",
                    "range and bearing, frames of one to four bytes", kRabCommand},
};

}  // namespace

std::span<const CataloguedImage> catalogued_images() {
    return kImages;
}

const CataloguedImage* catalogued(std::string_view sha256) {
    const auto found = std::find_if(kImages.begin(), kImages.end(),
                                    [&](const CataloguedImage& image) { return image.sha256 == sha256; });
    return found == kImages.end() ? nullptr : &*found;
}

std::filesystem::path images_folder() {
    const char* folder = std::getenv("PUCKLOOP_IMAGES");
    return folder == nullptr ? std::filesystem::path() : std::filesystem::path(folder);
}

}  // namespace puckloop::tools

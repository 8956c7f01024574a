// The functions of Vulkan, found when the program runs: luxel starts without libvulkan, too.
#define VOLK_IMPLEMENTATION
#include <volk.h>

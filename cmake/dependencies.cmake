# Debian 12's packages; ./run has the list to install. Nothing is downloaded.
find_package(Vulkan QUIET GLOBAL)      # libvulkan-dev, or an SDK named by VULKAN_SDK
if(NOT TARGET Vulkan::Headers)
  find_package(VulkanHeaders REQUIRED GLOBAL)  # the headers alone
endif()
find_package(nlohmann_json REQUIRED)   # nlohmann-json3-dev
find_package(meshoptimizer REQUIRED)   # libmeshoptimizer-dev
find_package(draco REQUIRED)           # libdraco-dev
find_path(STB_INCLUDE_DIR stb/stb_image.h REQUIRED)  # libstb-dev
find_path(VOLK_INCLUDE_DIR volk.h REQUIRED)          # libvulkan-volk-dev
find_path(LIBDEFLATE_INCLUDE_DIR libdeflate.h REQUIRED)  # libdeflate-dev
find_library(LIBDEFLATE_LIBRARY deflate REQUIRED)
find_path(LZMA_INCLUDE_DIR lzma.h REQUIRED)  # liblzma-dev
find_library(LZMA_LIBRARY lzma REQUIRED)
find_path(SPNG_INCLUDE_DIR spng.h REQUIRED)  # libspng-dev
find_library(SPNG_LIBRARY spng REQUIRED)
find_path(TURBOJPEG_INCLUDE_DIR turbojpeg.h REQUIRED)  # libturbojpeg0-dev
find_library(TURBOJPEG_LIBRARY turbojpeg REQUIRED)
find_path(WEBP_INCLUDE_DIR webp/decode.h REQUIRED)  # libwebp-dev
find_library(WEBP_LIBRARY webp REQUIRED)

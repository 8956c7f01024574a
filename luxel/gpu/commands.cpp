#include "luxel/gpu/commands.h"

namespace luxel::gpu {

Result<Commands> Commands::make(const Device& device) {
  Commands out(device);
  auto pool_info = structure<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  pool_info.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool_info.queueFamilyIndex = device.queue_family;
  VkCommandPool pool = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(check(device.vk.vkCreateCommandPool(device.device, &pool_info, nullptr, &pool),
                         "cannot record the device's commands"));
  out.pool_ = {device, pool};
  auto type = structure<VkSemaphoreTypeCreateInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO);
  type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
  auto info = structure<VkSemaphoreCreateInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO);
  info.pNext = &type;
  VkSemaphore timeline = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(check(device.vk.vkCreateSemaphore(device.device, &info, nullptr, &timeline),
                         "cannot wait for the device's commands"));
  out.timeline_ = {device, timeline};
  return out;
}

Commands::~Commands() {
  if (pool_.get() != VK_NULL_HANDLE) static_cast<void>(wait(last_));
}

Result<VkCommandBuffer> Commands::next_buffer() {
  uint64_t done = 0;
  device_->vk.vkGetSemaphoreCounterValue(device_->device, timeline_.get(), &done);
  if (!given_.empty() && given_.front().number <= done) {
    const VkCommandBuffer buffer = given_.front().buffer;
    given_.pop_front();
    return buffer;
  }
  auto info =
      structure<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  info.commandPool = pool_.get();
  info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  info.commandBufferCount = 1;
  VkCommandBuffer buffer = VK_NULL_HANDLE;
  LUXEL_TRY_STATUS(check(device_->vk.vkAllocateCommandBuffers(device_->device, &info, &buffer),
                         "cannot record the device's commands"));
  return buffer;
}

Result<uint64_t> Commands::submit(const Record& record, WindowSemaphores window) {
  LUXEL_TRY(const VkCommandBuffer buffer, next_buffer());
  auto begin = structure<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  device_->vk.vkBeginCommandBuffer(buffer, &begin);
  record(buffer);
  LUXEL_TRY_STATUS(check(device_->vk.vkEndCommandBuffer(buffer), "the device's commands"));

  auto buffers = structure<VkCommandBufferSubmitInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO);
  buffers.commandBuffer = buffer;
  auto wait = structure<VkSemaphoreSubmitInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO);
  wait.semaphore = window.wait_for;
  wait.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  VkSemaphoreSubmitInfo signals[2] = {wait, wait};
  signals[0].semaphore = timeline_.get();
  signals[0].value = last_ + 1;
  signals[1].semaphore = window.signal;
  auto info = structure<VkSubmitInfo2>(VK_STRUCTURE_TYPE_SUBMIT_INFO_2);
  info.waitSemaphoreInfoCount = window.wait_for != VK_NULL_HANDLE;
  info.pWaitSemaphoreInfos = &wait;
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &buffers;
  info.signalSemaphoreInfoCount = window.signal != VK_NULL_HANDLE ? 2 : 1;
  info.pSignalSemaphoreInfos = signals;
  {
    const std::lock_guard lock(device_->queue_mutex);
    LUXEL_TRY_STATUS(check(device_->vk.vkQueueSubmit2KHR(device_->queue, 1, &info, VK_NULL_HANDLE),
                           "the device's work"));
  }
  given_.push_back({++last_, buffer});
  return last_;
}

Status Commands::wait(uint64_t number) {
  auto info = structure<VkSemaphoreWaitInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO);
  const VkSemaphore timeline = timeline_.get();
  info.semaphoreCount = 1;
  info.pSemaphores = &timeline;
  info.pValues = &number;
  return check(device_->vk.vkWaitSemaphores(device_->device, &info, UINT64_MAX),
               "the device's work");
}

Status Commands::run(const Record& record) {
  LUXEL_TRY(const uint64_t number, submit(record));
  return wait(number);
}

void full_barrier(const Device& device, VkCommandBuffer commands) {
  auto all = structure<VkMemoryBarrier2>(VK_STRUCTURE_TYPE_MEMORY_BARRIER_2);
  all.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  all.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_2_HOST_BIT;
  all.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  all.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  auto info = structure<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &all;
  device.vk.vkCmdPipelineBarrier2KHR(commands, &info);
}

Status copy_bytes(Commands& commands, const Buffer& from, const Buffer& to, VkDeviceSize bytes) {
  const Device& device = commands.device();
  return commands.run([&](VkCommandBuffer c) {
    const VkBufferCopy some{0, 0, bytes};
    full_barrier(device, c);
    device.vk.vkCmdCopyBuffer(c, from.buffer.get(), to.buffer.get(), 1, &some);
    full_barrier(device, c);
  });
}

Result<Buffer> uploaded(Commands& commands, std::span<const std::byte> bytes,
                        std::string_view what) {
  const Device& device = commands.device();
  LUXEL_TRY(const Buffer sent, buffer_with(device, bytes, what));
  LUXEL_TRY(Buffer out, make_buffer(device, bytes.size(), Access::device, what));
  LUXEL_TRY_STATUS(copy_bytes(commands, sent, out, bytes.size()));
  return out;
}

}  // namespace luxel::gpu

/* Dermis: a data-driven frame graph for subsurface scattering, embedded in a host engine.
 *
 * DERMIS DOES
 *   - read a frame graph from JSON, check it, compile it to a plan, and record the plan into your
 *     command buffer;
 *   - own its pipelines, descriptors, transient and history images, and timestamp queries;
 *   - return every image in the state that you request.
 * DERMIS DOES NOT
 *   - create an instance, a device or a queue; submit; wait; present; start a thread; print; open a
 *     file;
 *   - access an image or a buffer that you did not bind, or keep a pointer of yours after a call
 *     returns, except callbacks.
 *
 * STEP BY STEP
 *   1. dermis_context_create       once per device, with the device's functions
 *   2. dermis_graph_create         a JSON graph at a size; errors are in a report
 *   3. dermis_graph_slots          the images that the graph needs, by name and number
 *   4. each frame: fill a dermis_frame (bindings, camera, frame numbers), call dermis_view_record,
 *      submit yourself
 *   5. dermis_graph_destroy, dermis_context_destroy, after the device has finished the frames
 *   More cameras (stereo, split screen): dermis_view_create once each.
 *   Budgets of time and memory, and what they choose: dermis/choice.h, included at the end.
 *
 * BARRIER CONTRACT
 *   Before dermis_view_record each bound image is in `before.layout`, and its last access is
 *   `before.stages` and `before.access`. At the end of the recorded commands the image is in
 *   `after.layout`, visible to `after.stages` and `after.access`. If `after` equals `before`, you
 *   get the image back in the state in which you passed it. Buffers and acceleration structures
 *   follow the same rule, without layouts. Combined depth-stencil images: both aspects are in
 *   `before.layout` and return in `after.layout`. Only the depth aspect changes, and stencil is not
 *   accessed, if one of these is a depth-only layout or the context has
 *   DERMIS_CONTEXT_SEPARATE_DEPTH_STENCIL.
 *
 * STRUCTS
 *   Every struct starts with `struct_size`; use its DERMIS_..._INIT. Zero means default. A call
 *   with a struct smaller than the library's returns DERMIS_ERROR_ARGUMENT. A struct of a newer
 *   header is accepted if the part unknown to the library is zero; otherwise the call returns
 *   DERMIS_ERROR_VERSION. The struct_size of the first element is the stride of an array, and the
 *   library writes at most that many bytes per element. Structs that are members of others
 *   (dermis_source, dermis_image_state) never grow.
 *
 * ERRORS
 *   A function whose comment has no "Errors:" cannot fail. The result is for logic; the log
 *   callback gets all messages as they occur, dermis_last_error has the first error. The report has
 *   all messages about files, settings and the device; it stays NULL where a call fails with
 *   ARGUMENT, VERSION or MEMORY before it reads them, or after a device loss. A failed call changes
 *   nothing. NULL for a required pointer and a null handle return DERMIS_ERROR_ARGUMENT; destroy
 *   functions ignore NULL. After DERMIS_ERROR_DEVICE_LOST, calls that create, change, record or
 *   report times of frames return it again; other queries and destroy functions still work.
 *
 * THREADS
 *   Each function states its threads:
 *   - "Any": from any thread, at any time.
 *   - "One per view": no two calls with the same view at the same time. Different views are
 *     independent, and so are graphs.
 *   - "Concurrent": from any thread, also while other threads record views of the graph. These
 *     continue with the state they have; changes of one graph wait for each other.
 *   - "Exclusive": from any thread, while no other thread uses the object.
 *
 * COSTS
 *   Each function states what it may cost: "pipelines": it creates some; "memory": it allocates
 *   device memory; "time": it may take more than 1 ms; "none".
 *
 * TWO-CALL ARRAYS
 *   Call with the array NULL to get the count. Then call with an array whose first element has
 *   struct_size set, and *count elements. DERMIS_INCOMPLETE: the array was too short.
 */
#ifndef DERMIS_DERMIS_H
#define DERMIS_DERMIS_H

#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan_core.h>

#if defined(_WIN32)
#define DERMIS_CALL __cdecl
#if defined(DERMIS_BUILDING)
#define DERMIS_API __declspec(dllexport)
#elif defined(DERMIS_STATIC)
#define DERMIS_API
#else
#define DERMIS_API __declspec(dllimport)
#endif
#else
#define DERMIS_CALL
#define DERMIS_API __attribute__((visibility("default")))
#endif
#ifdef __cplusplus
extern "C" {
#endif

#define DERMIS_VERSION_MAJOR 0
#define DERMIS_VERSION_MINOR 1
#define DERMIS_VERSION_PATCH 0
#define DERMIS_ABI_VERSION 1u /* of this header, for dermis_context_desc.abi_version */

typedef enum dermis_result {
  DERMIS_OK = 0,
  DERMIS_ERROR_ARGUMENT = -1,  /* a pointer, size or range is wrong; nothing changed */
  DERMIS_ERROR_VERSION = -2,   /* the header is newer than the library and uses new fields */
  DERMIS_ERROR_CONFIG = -3,    /* errors in a graph or profile, see the report; nothing changed */
  DERMIS_ERROR_SHADER = -4,    /* a kernel does not match its signature, or the device rejects it */
  DERMIS_ERROR_UNSUPPORTED = -5, /* the device lacks something; the report lists all of it */
  DERMIS_ERROR_MEMORY = -6,    /* out of host memory; nothing changed */
  DERMIS_ERROR_DEVICE_MEMORY = -7, /* out of device memory; nothing changed */
  DERMIS_ERROR_VULKAN = -8,    /* a Vulkan call failed; the message names call and result */
  DERMIS_ERROR_DEVICE_LOST = -9, /* destroy everything */
  DERMIS_ERROR_INTERNAL = -10, /* a defect of the library; please report it with the message */
  DERMIS_INCOMPLETE = 1,       /* the array was too short; count holds the required size */
  DERMIS_NOT_READY = 2, /* no frame has completed since the graph was created or replaced */
  DERMIS_RESULT_FORCE_32BIT = 0x7fffffff
} dermis_result;

typedef enum dermis_severity {
  DERMIS_SEVERITY_NOTE = 0,
  DERMIS_SEVERITY_WARNING = 1,
  DERMIS_SEVERITY_ERROR = 2,
  DERMIS_SEVERITY_FORCE_32BIT = 0x7fffffff
} dermis_severity;

typedef struct dermis_context_t* dermis_context;
typedef struct dermis_graph_t* dermis_graph;
typedef struct dermis_view_t* dermis_view;
typedef struct dermis_report_t* dermis_report;

/* One message. Strings belong to the report or, in a log call, to the library until the call
 * returns. */
typedef struct dermis_message {
  size_t struct_size;
  dermis_severity severity;
  uint32_t code;         /* stable number, documented in docs/diagnostics.md */
  const char* code_name; /* "unknown_key" */
  const char* file;      /* as named by the caller; "" if there is none */
  uint32_t line, column; /* from 1; 0 if there is none */
  const char* pointer;   /* JSON pointer */
  const char* text;      /* what is wrong, what was expected, what was found */
  const char* hint;      /* what to do */
} dermis_message;
#define DERMIS_MESSAGE_INIT \
  {sizeof(dermis_message), DERMIS_SEVERITY_NOTE, 0, NULL, NULL, 0, 0, NULL, NULL, NULL}
/* Called only from threads that are inside a Dermis call. Must not call Dermis. */
typedef void(DERMIS_CALL* dermis_log_fn)(void* user, const dermis_message* message);

/* ---- version --------------------------------------------------------------------------------- */
/* Returns major << 22 | minor << 12 | patch. Costs: none. Thread: any. */
DERMIS_API uint32_t DERMIS_CALL dermis_version(void);
/* Returns a static string, never NULL, also for unknown values. Costs: none. Thread: any. */
DERMIS_API const char* DERMIS_CALL dermis_result_name(dermis_result result);

/* ---- before the device exists ---------------------------------------------------------------- */
typedef enum dermis_requirement_type {
  DERMIS_REQUIREMENT_API_VERSION = 0, /* `version` holds VK_API_VERSION_1_2 */
  DERMIS_REQUIREMENT_FEATURE = 1,     /* a VkBool32 in a VkPhysicalDevice...Features struct */
  DERMIS_REQUIREMENT_DEVICE_EXTENSION = 2,
  DERMIS_REQUIREMENT_TYPE_FORCE_32BIT = 0x7fffffff
} dermis_requirement_type;

typedef struct dermis_requirement {
  size_t struct_size;
  dermis_requirement_type type;
  uint32_t version;
  const char* name;  /* static string */
  uint32_t required; /* 1: dermis_context_create fails without it; 0: used if enabled */
  uint32_t present;  /* 1: the physical device has it */
  const char* why;   /* static string */
} dermis_requirement;
#define DERMIS_REQUIREMENT_INIT \
  {sizeof(dermis_requirement), DERMIS_REQUIREMENT_API_VERSION, 0, NULL, 0, 0, NULL}
/* Lists the requirements on a device. Create the instance with VkApplicationInfo.apiVersion
 * VK_API_VERSION_1_3: older instances hide features that the device has.
 * Two-call array. Costs: time. Thread: any. Errors: ARGUMENT, INCOMPLETE, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_query_requirements(
    PFN_vkGetInstanceProcAddr get_instance_proc_addr, VkInstance instance,
    VkPhysicalDevice physical_device, uint32_t* count, dermis_requirement* items);

/* ---- memory of the host ---------------------------------------------------------------------- */
/* Allocates host memory for calls with a context, a graph, a view or one of their reports.
 * `alignment` is a power of two, at least 16. Return NULL on failure; the call then fails with
 * DERMIS_ERROR_MEMORY. Called from any thread that is inside a Dermis call. Must not call Dermis or
 * throw. */
typedef void*(DERMIS_CALL* dermis_allocate_fn)(void* user, size_t size, size_t alignment);
typedef void(DERMIS_CALL* dermis_free_fn)(void* user, void* memory, size_t size, size_t alignment);

/* Both functions must be callable until the last object and report that use them are destroyed.
 * Not used by dermis_validate, which has no context, nor for the few bytes that the C++ run time
 * needs to throw std::bad_alloc. In the static library and in builds with sanitizers,
 * dermis_context_create rejects an allocator with UNSUPPORTED. */
typedef struct dermis_allocator {
  size_t struct_size;
  dermis_allocate_fn allocate;
  dermis_free_fn free;
  void* user;
} dermis_allocator;
#define DERMIS_ALLOCATOR_INIT {sizeof(dermis_allocator), NULL, NULL, NULL}

typedef enum dermis_memory_purpose {
  DERMIS_MEMORY_TRANSIENT = 0, /* contents matter only within the commands of one recorded frame */
  DERMIS_MEMORY_HISTORY = 1,   /* contents last from frame to frame */
  DERMIS_MEMORY_CONSTANTS = 2, /* frame constants, tables, counters, placeholders */
  DERMIS_MEMORY_PURPOSE_FORCE_32BIT = 0x7fffffff
} dermis_memory_purpose;

typedef struct dermis_memory_request {
  size_t struct_size;
  dermis_memory_purpose purpose;
  uint32_t memory_types; /* bit i: memory type i of the device is acceptable */
  uint64_t bytes;
  uint64_t alignment; /* of dermis_memory_block.offset; a power of two */
  VkMemoryPropertyFlags required, preferred;
} dermis_memory_request;
#define DERMIS_MEMORY_REQUEST_INIT \
  {sizeof(dermis_memory_request), DERMIS_MEMORY_TRANSIENT, 0, 0, 0, 0, 0}

typedef struct dermis_memory_block {
  size_t struct_size;
  VkDeviceMemory memory;
  uint64_t offset; /* bytes */
  void* mapped;    /* host address while the library uses the block; needed if HOST_VISIBLE */
  void* user;      /* passed on to free with the block */
} dermis_memory_block;
#define DERMIS_MEMORY_BLOCK_INIT {sizeof(dermis_memory_block), VK_NULL_HANDLE, 0, NULL, NULL}

/* Fills *block and returns VK_SUCCESS, or returns the error that vkAllocateMemory would return. A
 * block may be a part of larger memory. Commands of the host may use a transient block before and
 * after a recorded frame if a barrier over ALL_COMMANDS and MEMORY_WRITE | MEMORY_READ orders them
 * with the frame; the block's contents are then undefined. Blocks are freed one by one when no
 * frame can use them any more. Called inside create, reload, resize, set_setting, set_profile,
 * record and destroy, by their threads; free also inside queries that run while a graph is
 * replaced. Must not call Dermis. */
typedef VkResult(DERMIS_CALL* dermis_allocate_memory_fn)(
    void* user, const dermis_memory_request* request, dermis_memory_block* block);
typedef void(DERMIS_CALL* dermis_free_memory_fn)(void* user, const dermis_memory_block* block);

typedef struct dermis_device_allocator {
  size_t struct_size;
  dermis_allocate_memory_fn allocate;
  dermis_free_memory_fn free;
  void* user;
} dermis_device_allocator;
#define DERMIS_DEVICE_ALLOCATOR_INIT {sizeof(dermis_device_allocator), NULL, NULL, NULL}

/* ---- context --------------------------------------------------------------------------------- */
#define DERMIS_CONTEXT_TIMINGS 0x1u /* writes timestamps around each pass */
#define DERMIS_CONTEXT_LABELS 0x2u  /* labels and object names; needs VK_EXT_debug_utils enabled */
/* The device was created with VK_KHR_ray_query, VK_KHR_acceleration_structure and their features.
 * Options that require "ray_query" are then available. */
#define DERMIS_CONTEXT_RAY_QUERY 0x4u
/* The device was created with separateDepthStencilLayouts. Of combined depth-stencil images only
 * the depth aspect then changes its layout. */
#define DERMIS_CONTEXT_SEPARATE_DEPTH_STENCIL 0x8u
/* Use the kernels for GPUs, or those for drivers on the CPU, on any device. Not both; for tests. */
#define DERMIS_CONTEXT_GPU_KERNELS 0x10u
#define DERMIS_CONTEXT_CPU_KERNELS 0x20u
/* Use no group of more than 128 invocations, as on devices that allow no larger one; for tests. */
#define DERMIS_CONTEXT_SMALL_GROUPS 0x40u
/* Histories share no memory with other configurations of a graph, so that all transients are
 * DERMIS_MEMORY_TRANSIENT. For hosts that alias this memory with their own. */
#define DERMIS_CONTEXT_SEPARATE_HISTORIES 0x80u

typedef struct dermis_context_desc {
  size_t struct_size;
  uint32_t abi_version;      /* DERMIS_ABI_VERSION */
  uint32_t flags;            /* DERMIS_CONTEXT_.. */
  uint32_t frames_in_flight; /* 1..8; 0 = 2 */
  uint32_t queue_family;     /* of your command buffers; must support compute */
  VkInstance instance;
  VkPhysicalDevice physical_device;
  VkDevice device;
  PFN_vkGetInstanceProcAddr get_instance_proc_addr;
  VkPipelineCache pipeline_cache;            /* may be null; must outlive the context */
  const VkAllocationCallbacks* vk_allocator; /* may be NULL; must outlive the context */
  dermis_log_fn log;                         /* may be NULL */
  void* log_user;
  const dermis_allocator* allocator;               /* host memory; NULL: the C library's */
  const dermis_device_allocator* device_allocator; /* device memory; NULL: vkAllocateMemory */
} dermis_context_desc;
#define DERMIS_CONTEXT_DESC_INIT \
  {sizeof(dermis_context_desc), DERMIS_ABI_VERSION, 0, 0, 0, NULL, NULL, NULL, NULL, \
   VK_NULL_HANDLE, NULL, NULL, NULL, NULL, NULL}
/* Resolves every Vulkan function by name and reports all that are missing. *context is NULL on
 * failure. Creates no pipelines. Costs: memory, time. Thread: any. Errors: ARGUMENT, VERSION,
 * UNSUPPORTED, MEMORY, DEVICE_MEMORY, VULKAN, DEVICE_LOST. */
DERMIS_API dermis_result DERMIS_CALL dermis_context_create(
    const dermis_context_desc* desc, dermis_context* context);
/* Destroys the context and the pipelines of its graphs. The device must have finished every frame
 * recorded through the context, and must still exist. Graphs that still exist are destroyed and
 * logged. NULL is ignored. Costs: time. Thread: exclusive. */
DERMIS_API void DERMIS_CALL dermis_context_destroy(dermis_context context);
/* Returns the last failure on this thread; NULL if there was none. A successful call does not clear
 * it. The text is valid until the next Dermis call on this thread. Costs: none. Thread: any. */
DERMIS_API const char* DERMIS_CALL dermis_last_error(void);

/* ---- reports --------------------------------------------------------------------------------- */
/* Returns the number of messages; 0 for NULL. Costs: none. Thread: any. */
DERMIS_API uint32_t DERMIS_CALL dermis_report_count(dermis_report report);
/* Returns message `index`, in order of discovery. Strings live as long as the report. Costs: none.
 * Thread: any. Errors: ARGUMENT. */
DERMIS_API dermis_result DERMIS_CALL dermis_report_message(
    dermis_report report, uint32_t index, dermis_message* message);
/* Returns all messages as text with excerpts of the sources; "" for NULL. Lives as long as the
 * report. Costs: time. Thread: any. */
DERMIS_API const char* DERMIS_CALL dermis_report_text(dermis_report report);
/* Returns all messages as a JSON array; "[]" for NULL. Lives as long as the report. Costs: time.
 * Thread: any. */
DERMIS_API const char* DERMIS_CALL dermis_report_json(dermis_report report);
/* NULL is ignored. Costs: none. Thread: exclusive. */
DERMIS_API void DERMIS_CALL dermis_report_destroy(dermis_report report);

/* ---- graphs ---------------------------------------------------------------------------------- */
/* JSON text. Copied during the call. */
typedef struct dermis_source {
  size_t struct_size;
  const char* name; /* for messages only, for example a file name; may be NULL */
  const char* text; /* need not be null-terminated */
  size_t length;    /* bytes */
} dermis_source;
#define DERMIS_SOURCE_INIT {sizeof(dermis_source), NULL, NULL, 0}

/* Subsurface profile of id `id` in the material image: 1..255; id 0 means no subsurface. */
typedef struct dermis_profile {
  size_t struct_size;
  uint32_t id;
  dermis_source source; /* a profile file */
} dermis_profile;
#define DERMIS_PROFILE_INIT {sizeof(dermis_profile), 0, DERMIS_SOURCE_INIT}

/* The format of the image that will be bound to a slot. */
typedef struct dermis_slot_format {
  size_t struct_size;
  const char* name; /* of the slot */
  VkFormat format;
} dermis_slot_format;
#define DERMIS_SLOT_FORMAT_INIT {sizeof(dermis_slot_format), NULL, VK_FORMAT_UNDEFINED}

/* Provides a file that a graph, a fragment or an overlay includes: fills *source and returns 1, or
 * returns 0 if there is none. `name` is relative, with '/' between folders and without "..". The
 * memory of *source must last until the Dermis call ends. Must not call Dermis. Called only during
 * dermis_graph_create and the functions that reload. */
typedef uint32_t(DERMIS_CALL* dermis_include_fn)(
    void* user, const char* name, dermis_source* source);

/* Parts that dermis_graph_reload keeps (dermis_graph_desc.keep) and whose fields it ignores. */
#define DERMIS_KEEP_SOURCE 0x1u
#define DERMIS_KEEP_SIZE 0x2u
#define DERMIS_KEEP_PROFILES 0x4u
#define DERMIS_KEEP_UNBOUND 0x8u
#define DERMIS_KEEP_FORMATS 0x10u
#define DERMIS_KEEP_OVERLAYS 0x20u
#define DERMIS_KEEP_INCLUDE 0x40u /* include and include_user */
#define DERMIS_KEEP_MEMORY 0x80u  /* max_bytes */
#define DERMIS_KEEP_ALL 0xffu

typedef struct dermis_graph_desc {
  size_t struct_size;
  dermis_source source;
  uint32_t width, height;         /* allocated size in pixels, 1..16384; frames render a part */
  const dermis_profile* profiles; /* NULL: no pass that serves scattering is in the plan */
  uint32_t profile_count;
  uint32_t unbound_count;
  const char* const* unbound;        /* names of optional slots that will not be bound */
  const dermis_slot_format* formats; /* of bound images; default: the first one declared */
  uint32_t format_count;
  uint32_t keep;            /* DERMIS_KEEP_... for dermis_graph_reload; 0 in dermis_graph_create. */
  const dermis_source* overlays; /* applied to the graph one after the other */
  uint32_t overlay_count;
  dermis_include_fn include; /* NULL: no includes; else callable as long as the graph lives */
  void* include_user;
  float pixel_aspect; /* width / height of a pixel, within 30 %; part of the size; 0: 1 */
  /* Budget of transient_bytes + history_bytes (dermis_memory) of one view; 0: none. Configurations
   * of choices "by": "budget" that do not fit are not offered and allocate nothing (D0405). If none
   * fits, the smallest one runs (D0406). */
  uint64_t max_bytes;
} dermis_graph_desc;
#define DERMIS_GRAPH_DESC_INIT \
  {sizeof(dermis_graph_desc), DERMIS_SOURCE_INIT, 0, 0, NULL, 0, 0, NULL, NULL, 0, 0, NULL, 0, \
   NULL, NULL, 0, 0}
/* Checks a graph without a device. The graph must not include other files. *report (may be NULL)
 * gets the messages. Costs: time. Thread: any. Errors: ARGUMENT, VERSION, CONFIG, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_validate(
    const dermis_source* source, dermis_report* report);
/* Parses, checks and compiles a graph, creates its pipelines and allocates device memory. Takes
 * tens of milliseconds; seconds if kernels are compiled. *graph is NULL on failure. *report (may be
 * NULL) gets the messages; destroy it also on success. Graphs of a context share pipelines: a graph
 * compiles only kernels that no other graph had. The context keeps the pipelines of the library's
 * kernels, but at most 16 unused variants of a kernel; pipelines of your shaders live as long as a
 * graph uses them. Costs: pipelines, memory, time. Thread: any. Errors: ARGUMENT, VERSION, CONFIG,
 * SHADER, UNSUPPORTED, MEMORY, DEVICE_MEMORY, VULKAN, DEVICE_LOST. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_create(
    dermis_context context, const dermis_graph_desc* desc, dermis_graph* graph,
    dermis_report* report);
/* Builds what dermis_graph_create would build from desc, next to the running graph, and replaces it
 * at the next record of each view. `desc.keep` names the parts that stay: DERMIS_KEEP_ALL &
 * ~DERMIS_KEEP_SOURCE replaces only the text of the graph, DERMIS_KEEP_ALL reads included files
 * again. Histories and settings with equal names continue; the report lists the others. A new size
 * acts like dermis_graph_resize. On failure nothing changes. Costs: as dermis_graph_create. Thread:
 * concurrent. Errors: as dermis_graph_create. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_reload(
    dermis_graph graph, const dermis_graph_desc* desc, dermis_report* report);
/* Replaces kernels by GLSL of the host, so that shaders can be edited while the program runs.
 * `open` provides "common/subsurface_combine.comp" and the files it includes, such as
 * "common/tiles.glsl"; the library provides bindings and constants. A kernel for which `open`
 * returns 0 is the library's; NULL as `open` restores all. The call fails if `open` provides none
 * of the graph's kernels. `open` must be callable until it is replaced or the graph is destroyed.
 * Otherwise like a reload: errors have file and line, on failure nothing changes, histories and
 * settings continue. The compiler uses the C library's memory. Takes seconds. Costs: as
 * dermis_graph_create. Thread: concurrent. Errors: as dermis_graph_create; UNSUPPORTED also if the
 * library was built without DERMIS_RUNTIME_SHADERS and `open` is not NULL. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_reload_shaders(
    dermis_graph graph, dermis_include_fn open, void* user, dermis_report* report);
/* Changes the allocated size of all views and keeps the pixel_aspect. Histories become invalid,
 * except images declared "on_resize": "rescale". Creates no pipelines of known kernels. Costs:
 * memory, time. Thread: concurrent. Errors: as dermis_graph_create. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_resize(
    dermis_graph graph, uint32_t width, uint32_t height, dermis_report* report);
/* Destroys the graph and its views. The device must have finished every frame recorded with them.
 * NULL is ignored. Costs: time. Thread: exclusive. */
DERMIS_API void DERMIS_CALL dermis_graph_destroy(dermis_graph graph);

typedef enum dermis_slot_type {
  DERMIS_SLOT_IMAGE = 0,                  /* bound by dermis_frame.bindings */
  DERMIS_SLOT_BUFFER = 1,                 /* bound by dermis_frame.buffers */
  DERMIS_SLOT_ACCELERATION_STRUCTURE = 2, /* bound by dermis_frame.structures */
  DERMIS_SLOT_TYPE_FORCE_32BIT = 0x7fffffff
} dermis_slot_type;

typedef struct dermis_slot {
  size_t struct_size;
  uint32_t id;               /* for the binding */
  uint32_t required;         /* 0: may stay unbound if listed in dermis_graph_desc.unbound */
  const char* name;          /* valid until a call replaces the slots, see dermis_graph_slots */
  uint32_t written;          /* 1: the graph writes it */
  uint32_t read;             /* 1: the graph reads its contents */
  VkFormat format;           /* that the plan was compiled for */
  VkImageUsageFlags usage;   /* needed at creation; for buffers VkBufferUsageFlags */
  VkImageLayout best_layout; /* of the first use: an image in this layout needs no transition */
  uint32_t width, height;    /* smallest extent of the image */
  uint32_t bound;            /* 1: every frame must bind it; 0: a binding is ignored */
  dermis_slot_type type;
  uint32_t stride; /* buffers: bytes per element */
  uint64_t bytes;  /* buffers: smallest size that a frame binds */
} dermis_slot;
#define DERMIS_SLOT_INIT \
  {sizeof(dermis_slot), 0, 0, NULL, 0, 0, VK_FORMAT_UNDEFINED, 0, VK_IMAGE_LAYOUT_UNDEFINED, 0, \
   0, 0, DERMIS_SLOT_IMAGE, 0, 0}
/* Returns the slots that the next record expects. Equal for all views. Call again after a reload, a
 * resize, set_setting, and set_profile that adds the first profile or removes the last: these
 * replace the slots. Two-call array. Costs: none. Thread: concurrent. Errors: ARGUMENT,
 * INCOMPLETE. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_slots(
    dermis_graph graph, uint32_t* count, dermis_slot* slots);

typedef enum dermis_describe_format {
  DERMIS_DESCRIBE_JSON = 0, /* the whole plan with reasons */
  DERMIS_DESCRIBE_DOT = 1,
  DERMIS_DESCRIBE_TEXT = 2,
  DERMIS_DESCRIBE_FORMAT_FORCE_32BIT = 0x7fffffff
} dermis_describe_format;
/* Describes the plan. *size in: capacity of `text`; out: required bytes, including the terminating
 * null. text may be NULL. Costs: time. Thread: concurrent. Errors: ARGUMENT, INCOMPLETE, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_describe(
    dermis_graph graph, dermis_describe_format format, size_t* size, char* text);

typedef struct dermis_memory {
  size_t struct_size;
  uint64_t transient_bytes;           /* heaps whose contents matter only within a frame */
  uint64_t transient_unaliased_bytes; /* all transients of the largest plan, without aliasing */
  uint64_t history_bytes;             /* heaps with histories, and transients that share them */
  uint64_t constant_bytes;            /* frame constants, profile and kernel tables */
} dermis_memory;
#define DERMIS_MEMORY_INIT {sizeof(dermis_memory), 0, 0, 0, 0}
/* Returns the device memory of all views together, without that of replaced graphs, which is freed
 * once their last frame has completed. Costs: none, but waits while another thread changes the
 * graph. Thread: concurrent. Errors: ARGUMENT, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_memory(dermis_graph graph, dermis_memory* memory);
/* Returns the memory blocks that one view of the graph needs for transients and histories, so that
 * a host can reserve them before it creates more views. Two-call array. Costs: none. Thread:
 * concurrent. Errors: ARGUMENT, INCOMPLETE, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_heaps(
    dermis_graph graph, uint32_t* count, dermis_memory_request* heaps);

typedef struct dermis_pass_timing {
  size_t struct_size;
  const char* pass;     /* lives until the next record or destroy */
  uint64_t frame_index; /* of the frame that was timed */
  uint64_t nanoseconds; /* device time */
} dermis_pass_timing;
#define DERMIS_PASS_TIMING_INIT {sizeof(dermis_pass_timing), NULL, 0, 0}

/* Why a history is not valid. */
typedef enum dermis_history_reason {
  DERMIS_HISTORY_NEVER_WRITTEN = 0, /* no recorded frame has written it */
  DERMIS_HISTORY_CUT = 1,           /* DERMIS_FRAME_RESET_HISTORY */
  DERMIS_HISTORY_RESIZED = 2,       /* and it is not declared "on_resize": "rescale" */
  DERMIS_HISTORY_RELOADED = 3,      /* the graph before the reload has no matching history */
  DERMIS_HISTORY_OTHER_PLAN = 4,    /* the plan of the previous frame has no matching history */
  DERMIS_HISTORY_LEFT_OUT = 5,      /* the previous frame had nothing to scatter */
  DERMIS_HISTORY_REASON_FORCE_32BIT = 0x7fffffff
} dermis_history_reason;

typedef struct dermis_history {
  size_t struct_size;
  const char* name;             /* lives as dermis_slot.name */
  uint32_t valid;               /* 1: the next frame reads the contents, unless it is a cut */
  uint32_t age;                 /* number of consecutive frames in it; 0 if it is not valid */
  dermis_history_reason reason; /* why it is not valid, or why it last was not */
  /* Number of frames after a change of a profile or of light until at most 1 % of the history is
   * from before the change, by the current weights. 1: the history holds only the last frame. */
  uint32_t settles_after;
  const char* text; /* the reason as a sentence, or "valid since ..."; static string */
} dermis_history;
#define DERMIS_HISTORY_INIT \
  {sizeof(dermis_history), NULL, 0, 0, DERMIS_HISTORY_NEVER_WRITTEN, 0, NULL}
/* Replaces profile `id` (1..255) by *source, adds it, or removes it if source is NULL. No graph is
 * built again and no history is lost; only the first profile of a graph and the removal of the last
 * one act like a reload. Frames in flight keep the old profile; each view uses the new one from its
 * next record on. Light accumulated over frames still shows the old profile for
 * dermis_history.settles_after frames; the report contains the number (D0625). Fits only the new
 * profile, which takes up to 0.3 s next to recording. Kept over reloads with DERMIS_KEEP_PROFILES
 * and over resizes. Costs: memory, time. Thread: concurrent. Errors: as dermis_graph_create. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_set_profile(
    dermis_graph graph, uint32_t id, const dermis_source* source, dermis_report* report);

typedef enum dermis_setting_type {
  DERMIS_SETTING_BOOL = 0,
  DERMIS_SETTING_INT = 1,
  DERMIS_SETTING_REAL = 2,
  DERMIS_SETTING_OPTION = 3, /* one of dermis_setting.options */
  DERMIS_SETTING_TYPE_FORCE_32BIT = 0x7fffffff
} dermis_setting_type;

/* A setting that the graph declares. Strings live until the next reload, resize, set_setting,
 * set_profile, reload_shaders or destroy. */
typedef struct dermis_setting {
  size_t struct_size;
  const char* name;
  dermis_setting_type type;
  uint32_t per_frame;        /* 1: a view may have its own value (dermis_view_set_setting) */
  const char* unit;          /* "px"; "" for none */
  const char* note;          /* the graph's description; "" for none */
  double minimum, maximum;   /* inclusive */
  double default_value;      /* bool: 0 or 1; option: index into options */
  double value;              /* of the next frame; of a chosen setting: of the last frame */
  uint32_t set;              /* 1: set by dermis_graph_set_setting; 2: by dermis_view_set_setting */
  uint32_t chosen;           /* 1: chosen by the budget in each frame, until the host sets it */
  const char* const* options; /* names; NULL if the type is not OPTION */
  uint32_t option_count;
} dermis_setting;
#define DERMIS_SETTING_INIT \
  {sizeof(dermis_setting), NULL, DERMIS_SETTING_BOOL, 0, NULL, NULL, 0, 0, 0, 0, 0, 0, NULL, 0}
/* Sets a setting for all views from JSON text ("16", "true", "\"post\""), effective at the next
 * record. json NULL: the graph file's default applies again, and a choice is made by the budget
 * again. A value that changes which passes run compiles a plan here; a new value of a switch or an
 * option creates pipelines. Costs: pipelines, memory, time. Thread: concurrent. Errors: ARGUMENT,
 * CONFIG, and those of dermis_graph_create. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_set_setting(
    dermis_graph graph, const char* name, const char* json, dermis_report* report);

/* ---- passes of the host ---------------------------------------------------------------------- */
/* How a pass of the host uses what a graph binds to a port, always in compute shaders: the graph's
 * barriers wait for, and make visible to, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT. */
typedef enum dermis_port_usage {
  DERMIS_PORT_SAMPLED_IMAGE = 0,        /* read in dermis_pass_port.layout */
  DERMIS_PORT_STORAGE_IMAGE_WRITE = 1,  /* written, GENERAL */
  DERMIS_PORT_STORAGE_IMAGE_UPDATE = 2, /* read and written, GENERAL */
  DERMIS_PORT_STORAGE_BUFFER_READ = 3,
  DERMIS_PORT_STORAGE_BUFFER_WRITE = 4,
  DERMIS_PORT_STORAGE_BUFFER_UPDATE = 5,
  DERMIS_PORT_ACCELERATION_STRUCTURE = 6, /* read by ray queries */
  DERMIS_PORT_USAGE_FORCE_32BIT = 0x7fffffff
} dermis_port_usage;

typedef struct dermis_port {
  size_t struct_size;
  const char* name; /* key in "read" or "write" of a pass: a letter or '_', then letters, digits,
                     * '_'; at most 64 bytes */
  const char* doc;  /* for schemas and messages; may be NULL */
  dermis_port_usage usage;
  uint32_t optional; /* 1: a graph may omit it */
  /* 1: each invocation reads only the texel or element that only it writes, before the write.
   * Required for a port that reads what another port of the pass writes; without it such graphs are
   * rejected (D0232). Update ports do not need it for their own accesses. */
  uint32_t own_texels;
  /* 1: the dispatch also reads through this port what its invocations wrote, and its shader orders
   * these accesses. Only for usages that write without reading (D0233). */
  uint32_t internally_ordered;
} dermis_port;
#define DERMIS_PORT_INIT {sizeof(dermis_port), NULL, NULL, DERMIS_PORT_SAMPLED_IMAGE, 0, 0, 0}

typedef enum dermis_pass_setting_type {
  DERMIS_PASS_SETTING_BOOL = 0,
  DERMIS_PASS_SETTING_INT = 1,
  DERMIS_PASS_SETTING_REAL = 2,
  DERMIS_PASS_SETTING_TYPE_FORCE_32BIT = 0x7fffffff
} dermis_pass_setting_type;

typedef struct dermis_pass_setting {
  size_t struct_size;
  const char* name; /* key in "set" of a pass */
  const char* unit; /* "px"; NULL or "": none */
  const char* doc;  /* may be NULL */
  dermis_pass_setting_type type;
  uint32_t per_frame;      /* 1: may differ between frames and views; 0: one value per graph */
  double default_value;    /* bool: 0 or 1 */
  double minimum, maximum; /* inclusive, within +-1e9; of int and real */
} dermis_pass_setting;
#define DERMIS_PASS_SETTING_INIT \
  {sizeof(dermis_pass_setting), NULL, NULL, NULL, DERMIS_PASS_SETTING_BOOL, 0, 0, 0, 0}

/* The image, buffer or acceleration structure at a port while a pass of the host is recorded; all
 * null if the port is unbound. */
typedef struct dermis_pass_port {
  size_t struct_size;
  VkImage image;
  VkImageView view; /* of the subresource that the graph names; storage images: of one mip */
  VkFormat format;
  VkImageLayout layout;   /* current layout; must be restored when the function returns */
  uint32_t width, height; /* of the view's first mip, in texels: the allocated size */
  VkBuffer buffer;
  uint64_t bytes;  /* of the buffer */
  uint64_t offset; /* first byte; not 0 only in buffers that you bind */
  VkAccelerationStructureKHR structure;
} dermis_pass_port;
#define DERMIS_PASS_PORT_INIT \
  {sizeof(dermis_pass_port), VK_NULL_HANDLE, VK_NULL_HANDLE, VK_FORMAT_UNDEFINED, \
   VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, VK_NULL_HANDLE, 0, 0, VK_NULL_HANDLE}

/* Valid until the function returns. The images and views of a dermis_view stay the same from frame
 * to frame until it is reloaded, resized or given a setting that changes its passes, and while the
 * same passes run: configurations of a choice by budget, and frames with empty bounds, may have
 * other images. Histories alternate between images. Descriptors that are kept have to be compared
 * with the ports. */
typedef struct dermis_pass_call {
  size_t struct_size;
  const char* pass; /* name of the pass in the graph */
  VkCommandBuffer command_buffer;
  const dermis_pass_port* ports; /* in declared order; the stride is ports[0].struct_size */
  const double* settings;        /* in declared order */
  uint32_t port_count, setting_count;
  uint32_t rect_x, rect_y, rect_width, rect_height; /* rendered part of the view in pixels */
  uint64_t frame_index;
  void* view_user; /* dermis_view_desc.user; NULL: the graph's own view */
} dermis_pass_call;
#define DERMIS_PASS_CALL_INIT \
  {sizeof(dermis_pass_call), NULL, NULL, NULL, NULL, 0, 0, 0, 0, 0, 0, 0, NULL}

/* Records the pass into the command buffer. Called inside dermis_view_record, by its thread. The
 * library records the barriers before and after the pass, as the ports declare: access only the
 * ports, and record no barrier around the pass. May bind any pipeline and descriptor sets. Must not
 * call Dermis or throw. */
typedef void(DERMIS_CALL* dermis_pass_fn)(void* user, const dermis_pass_call* call);

typedef struct dermis_pass_type {
  size_t struct_size;
  const char* name; /* "studio.bloom": two names with a dot between them, not "subsurface." */
  const char* doc;  /* may be NULL */
  const dermis_port* ports;
  const dermis_pass_setting* settings;
  uint32_t port_count;    /* 1..32 */
  uint32_t setting_count; /* 0..32 */
  uint32_t side_effects;  /* 1: passes of this pass type run even if nothing reads their output */
  /* 1: left out where nothing scatters: without profiles, and in frames with empty bounds. 0: also
   * runs there, unless a required input is written only by passes that are left out. */
  uint32_t serves_scattering;
  dermis_pass_fn record;
  void* user; /* passed to `record` */
} dermis_pass_type;
#define DERMIS_PASS_TYPE_INIT \
  {sizeof(dermis_pass_type), NULL, NULL, NULL, NULL, 0, 0, 0, 0, NULL, NULL}
/* Registers a pass type for the graphs of a context, so that the host's own passes are part of
 * the graph, with the same barriers, aliased memory and history. Copied, except `record` and
 * `user`, which are used as long as the context lives. Call before the context creates its first
 * graph. Costs: none. Thread: exclusive. Errors: ARGUMENT (also for a name that exists, or if there
 * are graphs), VERSION, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_register_pass_type(
    dermis_context context, const dermis_pass_type* type);
/* Returns the registered pass types as a JSON file for `dermis validate --pass-types FILE`, so that
 * graphs with them can be checked without the host. *size in: capacity of `text`; out: required
 * bytes, including the terminating null. text may be NULL. Costs: time. Thread: any. Errors:
 * ARGUMENT, INCOMPLETE, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_export_pass_types(
    dermis_context context, size_t* size, char* text);

/* ---- each frame ------------------------------------------------------------------------------ */
/* The state of an image, a buffer or an acceleration structure outside the recorded commands. With
 * `transfer` 1 the commands acquire it from `queue_family` (in `before`) or release it to that
 * family (in `after`). The host records the other half, with old and new layout both `layout`.
 * Acceleration structures are not transferred. */
typedef struct dermis_image_state {
  VkImageLayout layout;
  /* With transfer 1: index of a family, VK_QUEUE_FAMILY_EXTERNAL, or VK_QUEUE_FAMILY_FOREIGN_EXT if
   * the device was created with VK_EXT_queue_family_foreign. Otherwise 0 or
   * VK_QUEUE_FAMILY_IGNORED. */
  uint32_t queue_family;
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 access;
  uint32_t transfer; /* 1: ownership transfer between queue_family and the context's family */
} dermis_image_state;

/* Two slots of a frame may be bound to the same aspect and layers of an image, the same bytes of a
 * buffer, or the same acceleration structure only if the graph writes neither slot
 * (dermis_slot.written), their states are equal and transfer nothing, and, for images,
 * `before.layout` and `after.layout` are dermis_slot.best_layout, or equal to each other if that is
 * UNDEFINED. Depth and stencil are different aspects. */
typedef struct dermis_image_binding {
  size_t struct_size;
  uint32_t slot; /* dermis_slot.id */
  VkFormat format;
  VkImage image; /* 2-D, one sample, created with dermis_slot.usage */
  /* View of mip 0 and one layer; for depth formats of the depth aspect. May be null with a
   * content_id: then the library makes and keeps one. A recreated view needs a new content_id. */
  VkImageView view;
  uint32_t width, height; /* extent of mip 0 */
  dermis_image_state before, after;
  uint32_t layer;       /* first layer that is bound; 0 if layer_count is 0 */
  uint32_t layer_count; /* layers in these states; others are not accessed. 0: all layers */
  /* Your unique number of this image, never reused, because Vulkan reuses handles. Descriptors are
   * written only when it or the view changes. 0: nothing is kept from frame to frame. At most 8
   * images may alternate in a slot within the frames in flight. */
  uint64_t content_id;
} dermis_image_binding;
#define DERMIS_IMAGE_BINDING_INIT \
  {sizeof(dermis_image_binding), 0, VK_FORMAT_UNDEFINED, VK_NULL_HANDLE, VK_NULL_HANDLE, 0, 0, \
   {VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, 0, 0}, {VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, 0, 0}, 0, 0, 0}

/* A buffer at a slot of type BUFFER. Layouts of the states are VK_IMAGE_LAYOUT_UNDEFINED. */
typedef struct dermis_buffer_binding {
  size_t struct_size;
  uint32_t slot;   /* dermis_slot.id */
  VkBuffer buffer; /* created with dermis_slot.usage */
  uint64_t offset; /* a multiple of minStorageBufferOffsetAlignment */
  uint64_t bytes;  /* a multiple of dermis_slot.stride, at least dermis_slot.bytes */
  dermis_image_state before, after;
} dermis_buffer_binding;
#define DERMIS_BUFFER_BINDING_INIT \
  {sizeof(dermis_buffer_binding), 0, VK_NULL_HANDLE, 0, 0, {VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, 0, \
   0}, {VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, 0, 0}}

/* A top-level acceleration structure at a slot of type ACCELERATION_STRUCTURE. `before` also covers
 * the builds of everything below it. Layouts of the states are VK_IMAGE_LAYOUT_UNDEFINED,
 * `transfer` is 0. */
typedef struct dermis_acceleration_structure_binding {
  size_t struct_size;
  uint32_t slot; /* dermis_slot.id */
  VkAccelerationStructureKHR structure;
  dermis_image_state before, after;
} dermis_acceleration_structure_binding;
#define DERMIS_ACCELERATION_STRUCTURE_BINDING_INIT \
  {sizeof(dermis_acceleration_structure_binding), 0, VK_NULL_HANDLE, {VK_IMAGE_LAYOUT_UNDEFINED, \
   0, 0, 0, 0}, {VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, 0, 0}}

typedef enum dermis_depth_kind {
  DERMIS_DEPTH_DEVICE = 0,     /* depth test of clip_from_view; may be reversed, infinite */
  DERMIS_DEPTH_VIEW_UNITS = 1, /* distance along the view axis, world units; 0: no surface */
  DERMIS_DEPTH_KIND_FORCE_32BIT = 0x7fffffff
} dermis_depth_kind;

#define DERMIS_FRAME_RESET_HISTORY 0x1u /* camera cut, teleport, new level; trials may run */
#define DERMIS_FRAME_BOUNDS 0x2u        /* all subsurface is inside dermis_frame.bounds_... */
#define DERMIS_FRAME_LEFT_HANDED 0x4u   /* the camera looks along +z; see dermis_frame */

/* One frame. Matrices act on column vectors (clip = clip_from_view * view) and are stored row by
 * row: element [r * 4 + c]. Clip space is Vulkan's: y down, depth 0..1. View space is x right, y
 * up. In a right-handed view space the camera looks down -z, in a left-handed one (Unreal,
 * DirectXMath ...LH) along +z. A perspective projection states this by its last row: w = -z or w =
 * z; the flag is not needed. An orthographic projection cannot: set DERMIS_FRAME_LEFT_HANDED if its
 * view space is left-handed. All matrices of a frame and normal images use the same view space.
 * Matrices that contradict the flag, each other or the depth range (all of it behind the camera)
 * return DERMIS_ERROR_ARGUMENT. clip_from_view is the matrix that the picture was rendered with;
 * jitter_x and jitter_y state its sub-pixel shift. The previous matrices are those of the previous
 * frame; if they are not projection matrices (all 0), or view_from_world is not affine and
 * invertible, histories that follow surfaces restart in each frame. */
typedef struct dermis_frame {
  size_t struct_size;
  VkCommandBuffer command_buffer; /* recording, outside a render pass, of the context's family */
  const dermis_image_binding* bindings;
  uint32_t binding_count;
  uint32_t flags;       /* DERMIS_FRAME_.. */
  uint64_t frame_index; /* from 1; increases with every frame */
  /* Newest frame that the device has finished, at most frames_in_flight before; 0: none. */
  uint64_t completed_frame_index;
  uint32_t rect_x, rect_y, rect_width, rect_height; /* pixels; width 0: allocated size */
  float clip_from_view[16];
  float view_from_world[16];
  float previous_clip_from_view[16];
  float previous_view_from_world[16];
  float jitter_x, jitter_y; /* pixels, +x right, +y down: shift of the picture in clip_from_view */
  float metres_per_unit;    /* 0 = 1 */
  float exposure;           /* linear factor that the host applies later; 0 = 1 */
  float delta_seconds;
  dermis_depth_kind depth_kind;
  /* With DERMIS_FRAME_BOUNDS: the area that may show subsurface, in pixels of the images, clipped
   * to the rendered part. Empty: only passes that do not serve scattering run. */
  uint32_t bounds_x, bounds_y, bounds_width, bounds_height;
  const dermis_buffer_binding* buffers; /* the stride is buffers[0].struct_size */
  const dermis_acceleration_structure_binding* structures;
  uint32_t buffer_count, structure_count;
} dermis_frame;
#define DERMIS_FRAME_INIT \
  {sizeof(dermis_frame), NULL, NULL, 0, 0, 0, 0, 0, 0, 0, 0, {0}, {0}, {0}, {0}, 0, 0, 0, 0, 0, \
   DERMIS_DEPTH_DEVICE, 0, 0, 0, 0, NULL, NULL, 0, 0}

/* ---- a frame as data ------------------------------------------------------------------------- */
/* For a host that records all commands itself: calls of Vulkan functions with these arguments. */
typedef enum dermis_command_type {
  DERMIS_COMMAND_BARRIER = 0,    /* vkCmdPipelineBarrier2: dependency */
  DERMIS_COMMAND_DISPATCH = 1,   /* bind pipeline and `sets` from set 0, push constants, dispatch */
  DERMIS_COMMAND_DISPATCH_INDIRECT = 2, /* the same with the groups from buffer and offset */
  DERMIS_COMMAND_FILL_BUFFER = 3, /* buffer, offset, bytes, value */
  DERMIS_COMMAND_CLEAR_IMAGE = 4, /* vkCmdClearColorImage: image, image_layout, color, ranges */
  DERMIS_COMMAND_COPY_BUFFER = 5, /* buffer, to_buffer, buffer_copies */
  DERMIS_COMMAND_COPY_IMAGE = 6, /* image, image_layout, to_image, to_layout, image_copies */
  DERMIS_COMMAND_RESET_QUERIES = 7, /* query_pool, query, count */
  DERMIS_COMMAND_WRITE_TIMESTAMP = 8, /* vkCmdWriteTimestamp2: stages, query_pool, query */
  DERMIS_COMMAND_HOST_PASS = 9,  /* your pass: `call` with command_buffer NULL; not called */
  DERMIS_COMMAND_TYPE_FORCE_32BIT = 0x7fffffff
} dermis_command_type;

/* Fields that the type does not use are zero. All are compute or transfer commands. */
typedef struct dermis_command {
  size_t struct_size;
  dermis_command_type type;
  uint32_t count;   /* of ranges, regions or queries */
  const char* pass; /* name of the pass; "" for commands outside passes */
  const VkDependencyInfo* dependency;
  VkPipeline pipeline; /* VK_PIPELINE_BIND_POINT_COMPUTE */
  VkPipelineLayout layout;
  const VkDescriptorSet* sets;
  const void* push_constants; /* VK_SHADER_STAGE_COMPUTE_BIT, from offset 0 */
  uint32_t set_count, push_bytes;
  uint32_t groups[3];
  uint32_t value;
  VkBuffer buffer, to_buffer;
  uint64_t offset, bytes;
  VkImage image, to_image;
  VkImageLayout image_layout, to_layout;
  VkClearColorValue color;
  const VkImageSubresourceRange* ranges;
  const VkBufferCopy* buffer_copies;
  const VkImageCopy* image_copies;
  uint32_t query;
  VkQueryPool query_pool;
  VkPipelineStageFlags2 stages;
  const dermis_pass_call* call;
} dermis_command;
#define DERMIS_COMMAND_INIT \
  {sizeof(dermis_command), DERMIS_COMMAND_BARRIER, 0, NULL, NULL, VK_NULL_HANDLE, VK_NULL_HANDLE, \
   NULL, NULL, 0, 0, {0, 0, 0}, 0, VK_NULL_HANDLE, VK_NULL_HANDLE, 0, 0, VK_NULL_HANDLE, \
   VK_NULL_HANDLE, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_UNDEFINED, {{0, 0, 0, 0}}, NULL, \
   NULL, NULL, 0, VK_NULL_HANDLE, 0, NULL}

/* ---- views ----------------------------------------------------------------------------------- */
/* A view is a camera of a graph: an eye, a player of a split screen, a mirror. Each graph has one
 * (dermis_graph_view); dermis_view_create adds more. Views share the plan, pipelines, settings and
 * budget. Each view has its own histories, transient memory, frame numbers, measured times, and
 * values set by dermis_view_set_setting. All views have the graph's allocated size and slots; each
 * frame renders its own rectangle into its own images. */
typedef struct dermis_view_desc {
  size_t struct_size;
  void* user; /* dermis_pass_call.view_user */
} dermis_view_desc;
#define DERMIS_VIEW_DESC_INIT {sizeof(dermis_view_desc), NULL}
/* Returns the view that every graph has. Lives as long as the graph; dermis_view_destroy ignores
 * it. NULL for NULL. Costs: none. Thread: any. */
DERMIS_API dermis_view DERMIS_CALL dermis_graph_view(dermis_graph graph);
/* Allocates what a view needs; compiles nothing and creates no pipelines. desc may be NULL. *view
 * is NULL on failure. *report (may be NULL) gets the messages. Costs: memory, time. Thread:
 * concurrent. Errors: ARGUMENT, VERSION, MEMORY, DEVICE_MEMORY, VULKAN, DEVICE_LOST. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_create(
    dermis_graph graph, const dermis_view_desc* desc, dermis_view* view, dermis_report* report);
/* Destroys a view. The device must have finished every frame recorded with it. NULL is ignored. Do
 * not call after dermis_graph_destroy, which destroys all views. Costs: time. Thread: exclusive. */
DERMIS_API void DERMIS_CALL dermis_view_destroy(dermis_view view);
/* Records the plan. Never submits, waits for the device, prints, creates pipelines or allocates
 * host or device memory, except image views for bindings without one. On an error nothing was
 * recorded. Costs: none, except the image views, and the destruction of a replaced graph once its
 * last frame has completed. Thread: one per view. Errors: ARGUMENT, VERSION, VULKAN, DEVICE_LOST,
 * MEMORY, DEVICE_MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_record(
    dermis_view view, const dermis_frame* frame);
/* Like dermis_view_record, but returns the commands and ignores frame.command_buffer. They count as
 * a recorded frame: record all of them once, in order, outside a render pass, on a queue of the
 * context's family, or discard the frame with dermis_view_discard. The stride of *commands is its
 * first struct_size; the array lives until the next call that records this view, or its end.
 * Allocates host memory until the list has its final length. Costs: none. Thread: one per view.
 * Errors: as dermis_view_record. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_commands(
    dermis_view view, const dermis_frame* frame, uint32_t* count, const dermis_command** commands);
/* Discards the frame recorded last, which will never be submitted: the view is as before that
 * record, including histories, and frame_index may be used again. At most one frame, before the
 * next record, and before any call that compiles the graph again (reload, resize, reload_shaders,
 * set_setting, set_profile). The command buffer must not run. Costs:
 * none. Thread: one per view. Errors: ARGUMENT. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_discard(dermis_view view, uint64_t frame_index);
/* Returns the device times of the newest completed frame, in plan order. After a call that compiles
 * the graph again, they are those of earlier frames until the next record; then NOT_READY until a
 * frame recorded since has completed. Needs DERMIS_CONTEXT_TIMINGS and a queue with timestamps.
 * `completed_frame_index` as in dermis_frame. Two-call array. Costs: none. Thread: one per view.
 * Errors: ARGUMENT, INCOMPLETE, NOT_READY, MEMORY, DEVICE_LOST. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_timings(
    dermis_view view, uint64_t completed_frame_index, uint32_t* count, dermis_pass_timing* timings);
/* Returns each history of the graph, including those of plans that do not run now, as the plan that
 * ran last would find it. Discarded frames do not count. Two-call array. Costs: none. Thread: one
 * per view. Errors: ARGUMENT, INCOMPLETE, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_histories(
    dermis_view view, uint32_t* count, dermis_history* histories);
/* Returns the settings of the graph in the order of the file, with the values of this view.
 * Two-call array. Costs: as dermis_graph_memory. Thread: concurrent. Errors: ARGUMENT, INCOMPLETE,
 * MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_settings(
    dermis_view view, uint32_t* count, dermis_setting* settings);
/* Gives this view its own value of a setting with per_frame 1, effective at its next record; json
 * NULL restores the graph's value. Settings with per_frame 0 are rejected. Kept over reload and
 * resize. Costs: as dermis_graph_memory. Thread: concurrent. Errors: ARGUMENT, CONFIG, MEMORY,
 * DEVICE_LOST. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_set_setting(
    dermis_view view, const char* name, const char* json, dermis_report* report);

#ifdef __cplusplus
}
#endif
#include "choice.h"
#endif

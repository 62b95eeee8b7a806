/* Dermis: a data-driven frame graph for subsurface scattering, embedded in a host engine.
 *
 * DERMIS DOES
 *   - read a frame graph from JSON, check it, compile it to a plan, and record that plan into your command buffer;
 *   - own its pipelines, descriptors, transient and history images, and its timestamp queries;
 *   - put every image back into the state that you ask for.
 * DERMIS DOES NOT
 *   - create an instance, a device or a queue; submit; wait; present; make a thread; print; open a file;
 *   - touch an image or a buffer that you did not bind, or keep a pointer of yours after a call returns, but for callbacks.
 *
 * STEP BY STEP
 *   1. dermis_context_create       once per device, with the device's functions
 *   2. dermis_graph_create         a JSON graph at a size; errors come back in a report
 *   3. dermis_graph_slots          the images that the graph wants, by name and number
 *   4. each frame: fill a dermis_frame (bindings, camera, frame numbers), dermis_graph_record, submit yourself
 *   5. dermis_graph_destroy, dermis_context_destroy, after the device has finished the recorded frames
 *   More cameras (an eye each, a split screen): dermis_view_create once each, dermis_view_record each frame.
 *
 * BARRIER CONTRACT
 *   Before dermis_graph_record each bound image is in `before.layout` and was last touched by `before.stages` and
 *   `before.access`. At the end of the recorded commands it is in `after.layout`, visible to `after.stages` and
 *   `after.access`. If `after` equals `before` you get the image back as you gave it. Images are not touched
 *   outside of their bindings. Depth images are judged by their format. Of a combined depth-stencil image both aspects
 *   are in `before.layout` and come back in `after.layout`, unless one of these is a depth-only layout or the context has
 *   DERMIS_CONTEXT_SEPARATE_DEPTH_STENCIL: then only depth moves, and stencil is not touched. The same holds for buffers and acceleration
 *   structures, without layouts.
 *
 * STRUCTS
 *   Every struct starts with `struct_size`; use its DERMIS_..._INIT. Zero means default. A struct from a newer
 *   header is accepted when the part unknown to the library is zero, else DERMIS_ERROR_VERSION. An array is stepped
 *   by the struct_size of its first element, and the library fills no more than that of each. Structs that are
 *   members of others (dermis_source, dermis_image_state) never grow.
 *
 * ERRORS
 *   Each goes four ways with the same content: the result (for logic), the report (all messages), the log callback
 *   (as they happen) and dermis_last_error. A failed call changes nothing. NULL where a pointer is needed and a
 *   null handle are DERMIS_ERROR_ARGUMENT, never a crash; destroy functions ignore NULL. After
 *   DERMIS_ERROR_DEVICE_LOST only destroy.
 *
 * THREADS
 *   Stated at each function. "Any" means: from any thread, at any time. "One per view" means: no two calls with the
 *   same view at the same time; different views are independent, and so are graphs. A graph has a view of its own,
 *   which dermis_graph_record and dermis_frame_discard mean. "Beside" means: any, also while other threads record
 *   views of the graph: these go on with what they have, and changes of a graph wait for each other. Create and
 *   destroy come first and last: nobody else uses the object then.
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
/* The version of the interface in this header; goes into dermis_context_desc. */
#define DERMIS_ABI_VERSION 1u

typedef enum dermis_result {
  DERMIS_OK = 0,
  DERMIS_ERROR_ARGUMENT = -1,      /* a null, a size or a range is wrong: fix the call; nothing changed */
  DERMIS_ERROR_VERSION = -2,       /* the header is newer than the library and its new fields are used */
  DERMIS_ERROR_CONFIG = -3,        /* the graph or a profile has errors: see the report; a running graph runs on */
  DERMIS_ERROR_SHADER = -4,        /* a kernel does not fit its signature or the device refused it */
  DERMIS_ERROR_UNSUPPORTED = -5,   /* the device lacks something required; the report lists all of it */
  DERMIS_ERROR_MEMORY = -6,        /* host memory; the object is as before the call */
  DERMIS_ERROR_DEVICE_MEMORY = -7, /* device memory; the object is as before the call */
  DERMIS_ERROR_VULKAN = -8,        /* a Vulkan call failed; the message names call and result */
  DERMIS_ERROR_DEVICE_LOST = -9,   /* tear down */
  DERMIS_ERROR_INTERNAL = -10,     /* a defect of the library; please report it with the message */
  DERMIS_INCOMPLETE = 1,           /* the array was too short; count holds what is needed */
  DERMIS_NOT_READY = 2,            /* no completed frame yet */
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

/* One message. Strings belong to the report (or, in a log call, to the library until the call returns). */
typedef struct dermis_message {
  size_t struct_size;
  dermis_severity severity;
  uint32_t code;          /* stable number, documented in docs/diagnostics.md */
  const char* code_name;  /* "unknown_key" */
  const char* file;       /* as named by the caller; "" when there is none */
  uint32_t line, column;  /* from 1; 0 when there is none */
  const char* pointer;    /* JSON pointer */
  const char* text;       /* what is wrong, what was expected, what was found */
  const char* hint;       /* what to do */
} dermis_message;
#define DERMIS_MESSAGE_INIT {sizeof(dermis_message), DERMIS_SEVERITY_NOTE, 0, NULL, NULL, 0, 0, NULL, NULL, NULL}

/* May be called from any thread that is inside a Dermis call, never from another. Must not call Dermis. */
typedef void(DERMIS_CALL* dermis_log_fn)(void* user, const dermis_message* message);

/* ---- version ------------------------------------------------------------------------------------------- */

/* major << 22 | minor << 12 | patch. Thread: any. Errors: none. */
DERMIS_API uint32_t DERMIS_CALL dermis_version(void);
/* Static string, never NULL, also for unknown values. Thread: any. Errors: none. */
DERMIS_API const char* DERMIS_CALL dermis_result_name(dermis_result result);

/* ---- before the device exists ---------------------------------------------------------------------------- */

typedef enum dermis_requirement_kind {
  DERMIS_REQUIREMENT_API_VERSION = 0, /* version holds VK_API_VERSION_1_2 */
  DERMIS_REQUIREMENT_FEATURE = 1,     /* name of a VkBool32 in a VkPhysicalDevice...Features struct */
  DERMIS_REQUIREMENT_DEVICE_EXTENSION = 2,
  DERMIS_REQUIREMENT_KIND_FORCE_32BIT = 0x7fffffff
} dermis_requirement_kind;

typedef struct dermis_requirement {
  size_t struct_size;
  dermis_requirement_kind kind;
  uint32_t version;
  const char* name;  /* static string */
  uint32_t required; /* 1: without it dermis_context_create fails; 0: used if enabled */
  uint32_t present;  /* 1: the physical device has it */
  const char* why;   /* static string */
} dermis_requirement;
#define DERMIS_REQUIREMENT_INIT {sizeof(dermis_requirement), DERMIS_REQUIREMENT_API_VERSION, 0, NULL, 0, 0, NULL}

/* What the library needs of a device. Call with items NULL for the count, then with an array whose first
 * element has struct_size set. Create the instance with VkApplicationInfo.apiVersion VK_API_VERSION_1_3: an
 * instance of Vulkan 1.0 answers that features are absent which the device has. Thread: any. Errors:
 * ARGUMENT, INCOMPLETE. */
DERMIS_API dermis_result DERMIS_CALL dermis_query_requirements(PFN_vkGetInstanceProcAddr get_instance_proc_addr,
                                                               VkInstance instance, VkPhysicalDevice physical_device,
                                                               uint32_t* count, dermis_requirement* items);

/* ---- memory of the host ---------------------------------------------------------------------------------- */

/* Host memory for everything that calls with a context, a graph, a view or one of their reports keep or use on the way.
 * `alignment` is a power of two, 16 or more; NULL means: there is none, and the call fails with DERMIS_ERROR_MEMORY. May
 * be called from any thread that is inside a Dermis call. Must not call Dermis, and must not throw. */
typedef void*(DERMIS_CALL* dermis_allocate_fn)(void* user, size_t size, size_t alignment);
typedef void(DERMIS_CALL* dermis_release_fn)(void* user, void* memory, size_t size, size_t alignment);

/* Both functions must be callable until the last object and report that were made with them are destroyed. What goes
 * past it: dermis_validate, which knows no context, and the few bytes that the C++ run time takes to tell that memory
 * ran out. The static library and builds with sanitizers leave memory to the program: UNSUPPORTED there. */
typedef struct dermis_allocator {
  size_t struct_size;
  dermis_allocate_fn allocate;
  dermis_release_fn release;
  void* user;
} dermis_allocator;
#define DERMIS_ALLOCATOR_INIT {sizeof(dermis_allocator), NULL, NULL, NULL}

typedef enum dermis_memory_purpose {
  DERMIS_MEMORY_TRANSIENT = 0, /* means something from the first to the last command of a recorded frame only: scratch */
  DERMIS_MEMORY_HISTORY = 1,   /* from frame to frame */
  DERMIS_MEMORY_CONSTANTS = 2, /* frame constants, tables, counters, stand-ins of what is not bound */
  DERMIS_MEMORY_PURPOSE_FORCE_32BIT = 0x7fffffff
} dermis_memory_purpose;

typedef struct dermis_memory_request {
  size_t struct_size;
  dermis_memory_purpose purpose;
  uint32_t memory_types; /* bit i: memory type i of the device will do */
  uint64_t bytes;
  uint64_t alignment;    /* of dermis_memory_block.offset; a power of two */
  VkMemoryPropertyFlags required, preferred;
} dermis_memory_request;
#define DERMIS_MEMORY_REQUEST_INIT {sizeof(dermis_memory_request), DERMIS_MEMORY_TRANSIENT, 0, 0, 0, 0, 0}

typedef struct dermis_memory_block {
  size_t struct_size;
  VkDeviceMemory memory;
  uint64_t offset; /* bytes */
  void* mapped;    /* where the block begins for the host, as long as it is the library's; needed where HOST_VISIBLE is */
  void* user;      /* yours: comes back with the block */
} dermis_memory_block;
#define DERMIS_MEMORY_BLOCK_INIT {sizeof(dermis_memory_block), VK_NULL_HANDLE, 0, NULL, NULL}

/* Fills *block and returns VK_SUCCESS, or returns what vkAllocateMemory would. Blocks may be parts of larger memory. A
 * transient block may be used by commands of the host before and after a recorded frame, if these are ordered with the
 * frame by a barrier over ALL_COMMANDS and MEMORY_WRITE | MEMORY_READ: its contents are then the host's to lose. Blocks
 * go back one by one when no frame can use them any more. Called inside of create, reload, resize, set_setting,
 * set_profile, record and destroy calls, by their threads. Must not call Dermis. */
typedef VkResult(DERMIS_CALL* dermis_take_memory_fn)(void* user, const dermis_memory_request* request,
                                                     dermis_memory_block* block);
typedef void(DERMIS_CALL* dermis_give_back_memory_fn)(void* user, const dermis_memory_block* block);

typedef struct dermis_device_allocator {
  size_t struct_size;
  dermis_take_memory_fn take;
  dermis_give_back_memory_fn give_back;
  void* user;
} dermis_device_allocator;
#define DERMIS_DEVICE_ALLOCATOR_INIT {sizeof(dermis_device_allocator), NULL, NULL, NULL}

/* ---- context --------------------------------------------------------------------------------------------- */

#define DERMIS_CONTEXT_TIMINGS 0x1u /* write timestamps around each pass */
#define DERMIS_CONTEXT_LABELS 0x2u  /* debug labels and object names; needs VK_EXT_debug_utils enabled */
#define DERMIS_CONTEXT_RAY_QUERY 0x4u /* the device was created with VK_KHR_ray_query and VK_KHR_acceleration_structure and
                                         their features: options that require "ray_query" are offered */

#define DERMIS_CONTEXT_SEPARATE_DEPTH_STENCIL 0x8u /* the device was created with separateDepthStencilLayouts: of combined
                                                      depth-stencil images only the depth aspect changes its layout */

typedef struct dermis_context_desc {
  size_t struct_size;
  uint32_t abi_version;      /* DERMIS_ABI_VERSION */
  uint32_t flags;            /* DERMIS_CONTEXT_... */
  uint32_t frames_in_flight; /* 1..8; 0 = 2 */
  uint32_t queue_family;     /* of the command buffers that are recorded into; needs compute, not graphics */
  VkInstance instance;
  VkPhysicalDevice physical_device;
  VkDevice device;
  PFN_vkGetInstanceProcAddr get_instance_proc_addr;
  VkPipelineCache pipeline_cache;          /* may be null */
  const VkAllocationCallbacks* vk_allocator; /* may be NULL; must outlive the context */
  dermis_log_fn log;                       /* may be NULL */
  void* log_user;
  const dermis_allocator* allocator;       /* of host memory; NULL: the C library's */
  const dermis_device_allocator* device_allocator; /* of device memory; NULL: vkAllocateMemory */
} dermis_context_desc;
#define DERMIS_CONTEXT_DESC_INIT \
  {sizeof(dermis_context_desc), DERMIS_ABI_VERSION, 0, 0, 0, NULL, NULL, NULL, NULL, VK_NULL_HANDLE, NULL, NULL, NULL, NULL, NULL}

/* Resolves every Vulkan function by name and reports all that are missing at once. *context is NULL on failure.
 * Thread: any. Errors: ARGUMENT, VERSION, UNSUPPORTED, MEMORY, DEVICE_MEMORY, VULKAN, DEVICE_LOST. */
DERMIS_API dermis_result DERMIS_CALL dermis_context_create(const dermis_context_desc* desc, dermis_context* context);
/* The device must have finished every frame recorded through the context, and must still be there: pipelines go with
 * the context. Its graphs must have been destroyed (those that were not are destroyed here and logged). NULL is ignored.
 * Thread: any, alone. Errors: none. */
DERMIS_API void DERMIS_CALL dermis_context_destroy(dermis_context context);
/* The last failure on this thread; NULL for none. A call that succeeds leaves it alone. The text lives until the
 * next Dermis call on this thread. Thread: any. Errors: none. */
DERMIS_API const char* DERMIS_CALL dermis_last_error(void);

/* ---- reports --------------------------------------------------------------------------------------------- */

/* Number of messages; 0 for NULL. Thread: any. Errors: none. */
DERMIS_API uint32_t DERMIS_CALL dermis_report_count(dermis_report report);
/* Message `index`, in order of discovery. Strings live as long as the report. Thread: any. Errors: ARGUMENT. */
DERMIS_API dermis_result DERMIS_CALL dermis_report_message(dermis_report report, uint32_t index, dermis_message* message);
/* All messages as text for people, with excerpts; "" for NULL. Lives as long as the report. Thread: any. */
DERMIS_API const char* DERMIS_CALL dermis_report_text(dermis_report report);
/* All messages as a JSON array; "[]" for NULL. Lives as long as the report. Thread: any. Errors: none. */
DERMIS_API const char* DERMIS_CALL dermis_report_json(dermis_report report);
/* NULL is ignored. Thread: any, alone. Errors: none. */
DERMIS_API void DERMIS_CALL dermis_report_destroy(dermis_report report);

/* ---- graphs ---------------------------------------------------------------------------------------------- */

/* JSON text. Copied during the call. */
typedef struct dermis_source {
  size_t struct_size;
  const char* name; /* for messages only, for example a file name; may be NULL */
  const char* text; /* need not end in 0 */
  size_t length;    /* bytes */
} dermis_source;
#define DERMIS_SOURCE_INIT {sizeof(dermis_source), NULL, NULL, 0}

/* Subsurface profile number `id` (1..255, 0 means: no subsurface) of the material image. */
typedef struct dermis_profile {
  size_t struct_size;
  uint32_t id;
  uint32_t reserved;    /* 0 */
  dermis_source source; /* a profile file */
} dermis_profile;
#define DERMIS_PROFILE_INIT {sizeof(dermis_profile), 0, 0, DERMIS_SOURCE_INIT}

/* The format of the image that will be bound to a slot. */
typedef struct dermis_slot_format {
  size_t struct_size;
  const char* name; /* of the slot */
  VkFormat format;
  uint32_t reserved; /* 0 */
} dermis_slot_format;
#define DERMIS_SLOT_FORMAT_INIT {sizeof(dermis_slot_format), NULL, VK_FORMAT_UNDEFINED, 0}

/* Delivers a file that a graph, a fragment or an overlay includes: fills *source and returns 1, or returns 0 if there
 * is none. `name` is relative, with '/' between folders and without "..". What *source points into must last until the
 * Dermis call ends. Must not call Dermis. Called during dermis_graph_create and the functions that
 * reload only. */
typedef uint32_t(DERMIS_CALL* dermis_include_fn)(void* user, const char* name, dermis_source* source);

/* What dermis_graph_reload keeps as the graph has it (dermis_graph_desc.keep). Those fields are then not read. */
#define DERMIS_KEEP_SOURCE 0x1u
#define DERMIS_KEEP_SIZE 0x2u
#define DERMIS_KEEP_PROFILES 0x4u
#define DERMIS_KEEP_UNBOUND 0x8u
#define DERMIS_KEEP_FORMATS 0x10u
#define DERMIS_KEEP_OVERLAYS 0x20u
#define DERMIS_KEEP_INCLUDE 0x40u /* include and include_user */
#define DERMIS_KEEP_ALL 0x7fu

typedef struct dermis_graph_desc {
  size_t struct_size;
  dermis_source source;
  uint32_t width, height;          /* allocated view size in pixels, 1..16384; frames render a rectangle inside */
  const dermis_profile* profiles;  /* none: nothing scatters, and no pass that serves scattering is in the plan */
  uint32_t profile_count;
  uint32_t unbound_count;          /* names of optional slots that will not be bound */
  const char* const* unbound;
  const dermis_slot_format* formats; /* formats of the images to be bound; others: first declared */
  uint32_t format_count;
  uint32_t keep;                   /* of dermis_graph_reload: DERMIS_KEEP_...; 0 in dermis_graph_create */
  const dermis_source* overlays;   /* applied to the graph one after the other */
  uint32_t overlay_count;
  uint32_t reserved_too;           /* 0 */
  dermis_include_fn include;       /* NULL: nothing can be included; else callable as long as the graph lives */
  void* include_user;
} dermis_graph_desc;
#define DERMIS_GRAPH_DESC_INIT \
  {sizeof(dermis_graph_desc), DERMIS_SOURCE_INIT, 0, 0, NULL, 0, 0, NULL, NULL, 0, 0, NULL, 0, 0, NULL, NULL}

/* Checks a graph, which includes no other file, without a device. *report (may be NULL) gets the messages. Thread: any.
 * Errors: ARGUMENT, VERSION, CONFIG, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_validate(const dermis_source* source, dermis_report* report);
/* Parses, checks, compiles and allocates. *graph is NULL on failure. *report (may be NULL) gets the messages and
 * is to be destroyed also on success. Graphs of a context share their pipelines: one that is made beside or after others
 * compiles only kernels that none of them had. Those of the library's own kernels stay until the context is destroyed,
 * those of shaders of yours as long as a graph runs them. Thread: any. Errors: ARGUMENT, VERSION, CONFIG,
 * SHADER, UNSUPPORTED, MEMORY, DEVICE_MEMORY, VULKAN, DEVICE_LOST. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_create(dermis_context context, const dermis_graph_desc* desc,
                                                         dermis_graph* graph, dermis_report* report);
/* Builds what dermis_graph_create would build from desc, next to the running graph, and swaps it in at the next
 * record of each view. `desc.keep` names what stays as it is: DERMIS_KEEP_ALL & ~DERMIS_KEEP_SOURCE replaces only
 * the text of the graph, DERMIS_KEEP_ALL reads included files again. On failure nothing changes. Histories and
 * settings are carried over by name where they agree; the report lists what is not. A new size acts as
 * dermis_graph_resize. Thread: beside. Errors: as dermis_graph_create. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_reload(dermis_graph graph, const dermis_graph_desc* desc,
                                                         dermis_report* report);
/* Kernels from GLSL of the host's instead of those that the library was built with, so that shaders can be worked on
 * while the program runs. `open` delivers "subsurface_combine.comp" and what it includes, "include/tiles.glsl"; bindings
 * and constants come from the library. Kernels that it has none of stay the library's; NULL: all of them again. Callable
 * until it is replaced or the graph is destroyed. As a reload else: errors have file and line, on failure nothing changes,
 * histories and settings go on. What the compiler takes of memory is the C library's. Thread: beside. Errors: as
 * dermis_graph_create; UNSUPPORTED also where the library was built without DERMIS_RUNTIME_SHADERS. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_reload_shaders(dermis_graph graph, dermis_include_fn open, void* user,
                                                                 dermis_report* report);
/* A new allocated size of all views. Histories become invalid, but for images declared "on_resize": "rescale".
 * Thread: beside. Errors: as dermis_graph_create. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_resize(dermis_graph graph, uint32_t width, uint32_t height,
                                                         dermis_report* report);
/* Its views are destroyed with it. The device must have finished every frame recorded with them. NULL is ignored.
 * Thread: any, alone with this graph. */
DERMIS_API void DERMIS_CALL dermis_graph_destroy(dermis_graph graph);

typedef enum dermis_slot_type {
  DERMIS_SLOT_IMAGE = 0,                  /* dermis_frame.bindings */
  DERMIS_SLOT_BUFFER = 1,                 /* dermis_frame.buffers */
  DERMIS_SLOT_ACCELERATION_STRUCTURE = 2, /* dermis_frame.structures */
  DERMIS_SLOT_TYPE_FORCE_32BIT = 0x7fffffff
} dermis_slot_type;

typedef struct dermis_slot {
  size_t struct_size;
  uint32_t id;           /* goes into the binding */
  uint32_t required;     /* 0: may be left unbound if named so at creation */
  const char* name;      /* lives until the next reload, resize, set_setting or destroy */
  uint32_t written;      /* 1: the graph writes it */
  uint32_t read;         /* 1: the graph reads what is in it */
  VkFormat format;       /* that the plan was compiled for */
  VkImageUsageFlags usage; /* that the image must have been created with; of a buffer VkBufferUsageFlags */
  VkImageLayout best_layout; /* the layout of its first use: no transition needed if it comes so */
  uint32_t width, height; /* smallest extent of the image */
  uint32_t bound;        /* 1: every frame must bind it. 0: named as unbound at creation, a binding is ignored */
  dermis_slot_type type;
  uint32_t stride;       /* buffers: bytes of an element */
  uint64_t bytes;        /* buffers: least that a frame binds */
} dermis_slot;
#define DERMIS_SLOT_INIT \
  {sizeof(dermis_slot), 0, 0, NULL, 0, 0, VK_FORMAT_UNDEFINED, 0, VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, 0, DERMIS_SLOT_IMAGE, 0, 0}

/* The slots that the next record expects; ask again after a reload. The same for all views. Two-call array. Thread: beside.
 * Errors: ARGUMENT, INCOMPLETE. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_slots(dermis_graph graph, uint32_t* count, dermis_slot* slots);

typedef enum dermis_describe_format {
  DERMIS_DESCRIBE_JSON = 0, /* the whole plan with reasons */
  DERMIS_DESCRIBE_DOT = 1,
  DERMIS_DESCRIBE_TEXT = 2,
  DERMIS_DESCRIBE_FORMAT_FORCE_32BIT = 0x7fffffff
} dermis_describe_format;

/* *size in: room in `text`; out: bytes needed with the final 0. text may be NULL. Thread: beside.
 * Errors: ARGUMENT, INCOMPLETE. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_describe(dermis_graph graph, dermis_describe_format format,
                                                           size_t* size, char* text);

typedef struct dermis_memory {
  size_t struct_size;
  uint64_t transient_bytes;         /* image and buffer heaps that live within a frame */
  uint64_t transient_unaliased_bytes; /* each alone, rounded up to the alignment of its heap: never less */
  uint64_t history_bytes;
  uint64_t constant_bytes;          /* frame constants, profile and kernel tables */
} dermis_memory;
#define DERMIS_MEMORY_INIT {sizeof(dermis_memory), 0, 0, 0, 0}

/* Of all views together. Thread: beside. Errors: ARGUMENT. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_memory(dermis_graph graph, dermis_memory* memory);

/* The blocks of transients and histories that one view of the graph takes, so that a host can plan for them before it
 * makes more views. Two-call array. Thread: beside. Errors: ARGUMENT, INCOMPLETE. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_heaps(dermis_graph graph, uint32_t* count,
                                                        dermis_memory_request* heaps);

typedef struct dermis_pass_timing {
  size_t struct_size;
  const char* pass;      /* lives until the next record or destroy */
  uint64_t frame_index;  /* of the frame that was timed */
  uint64_t nanoseconds;  /* of device time */
} dermis_pass_timing;
#define DERMIS_PASS_TIMING_INIT {sizeof(dermis_pass_timing), NULL, 0, 0}

/* Device times of the newest completed frame, in plan order; needs DERMIS_CONTEXT_TIMINGS. `completed_frame_index`
 * as in dermis_frame. Of the graph's own view. Two-call array. Thread: one per view. Errors: ARGUMENT, INCOMPLETE,
 * NOT_READY, DEVICE_LOST. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_timings(dermis_graph graph, uint64_t completed_frame_index,
                                                          uint32_t* count, dermis_pass_timing* timings);

/* Why a history held nothing. */
typedef enum dermis_history_reason {
  DERMIS_HISTORY_NEVER_WRITTEN = 0, /* no frame has been recorded that writes it */
  DERMIS_HISTORY_CUT = 1,           /* DERMIS_FRAME_RESET_HISTORY */
  DERMIS_HISTORY_RESIZED = 2,       /* and it is not declared "on_resize": "rescale" */
  DERMIS_HISTORY_RELOADED = 3,      /* and what the graph was before has none that agrees with it */
  DERMIS_HISTORY_OTHER_PLAN = 4,    /* the frame before ran with a plan that has none that agrees with it */
  DERMIS_HISTORY_LEFT_OUT = 5,      /* the frame before had nothing to scatter (dermis_choice.skips) */
  DERMIS_HISTORY_REASON_FORCE_32BIT = 0x7fffffff
} dermis_history_reason;

typedef struct dermis_history {
  size_t struct_size;
  const char* name;             /* of the resource; lives until the next reload, resize, set_setting or destroy */
  uint32_t valid;               /* 1: the next frame, if it is no cut, finds what the frame before it wrote */
  uint32_t age;                 /* frames in a row that are in it; 0 where it is not valid */
  dermis_history_reason reason; /* why it is not valid; where it is, why it was not when it last was not */
  uint32_t settles_after;       /* frames after a change of a profile or of light until at most 1 % of the history
                                   is from before the change, by the weights that are set. 1: the last frame only */
  const char* text;             /* the reason for people; of a valid one "valid since ..."; static string */
} dermis_history;
#define DERMIS_HISTORY_INIT {sizeof(dermis_history), NULL, 0, 0, DERMIS_HISTORY_NEVER_WRITTEN, 0, NULL}

/* Each history of the graph, also of plans that do not run now, as the plan that ran last would find it. Frames that are
 * discarded do not count. Of the graph's own view. Two-call array. Thread: one per view. Errors: ARGUMENT, INCOMPLETE. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_histories(dermis_graph graph, uint32_t* count,
                                                            dermis_history* histories);

/* Replaces profile `id` (1..255) by the one in *source, adds it, or removes it where source is NULL. No graph is
 * built anew and no history is lost; only the first profile of a graph and the removal of the last one act as a
 * reload. Frames in flight keep the old profile; each view reads the new one from its next record on. What a view
 * accumulates over frames still shows the old profile for dermis_history.settles_after frames; the report says how
 * many (D0625). Takes up to 0.3 s, next to recording. Kept over reloads with DERMIS_KEEP_PROFILES and over resizes.
 * Thread: beside. Errors: as dermis_graph_create. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_set_profile(dermis_graph graph, uint32_t id,
                                                              const dermis_source* source, dermis_report* report);

typedef enum dermis_setting_type {
  DERMIS_SETTING_BOOL = 0,
  DERMIS_SETTING_INT = 1,
  DERMIS_SETTING_REAL = 2,
  DERMIS_SETTING_OPTION = 3, /* one of dermis_setting.options */
  DERMIS_SETTING_TYPE_FORCE_32BIT = 0x7fffffff
} dermis_setting_type;

/* A setting that the graph declares. Strings and options live until the next reload, resize, set_setting or destroy. */
typedef struct dermis_setting {
  size_t struct_size;
  const char* name;
  dermis_setting_type type;
  uint32_t per_frame;         /* 1: a view may have its own value (dermis_view_set_setting): a weight or a threshold.
                                 0: the value belongs to the graph */
  const char* unit;           /* "px"; "" for none */
  const char* note;           /* what the graph says about the setting; "" for nothing */
  double minimum, maximum;    /* inclusive */
  double default_value;       /* bool: 0 or 1; option: index into options */
  double value;               /* of the next frame; of a chosen setting: of the last frame */
  uint32_t set;               /* 1: dermis_graph_set_setting has set the value; 2: dermis_view_set_setting has */
  uint32_t chosen;            /* 1: the library chooses the value in each frame by the budget, until the host sets it */
  const char* const* options; /* names; NULL where the type is not OPTION */
  uint32_t option_count;
} dermis_setting;
#define DERMIS_SETTING_INIT \
  {sizeof(dermis_setting), NULL, DERMIS_SETTING_BOOL, 0, NULL, NULL, 0, 0, 0, 0, 0, 0, NULL, 0}

/* The settings that the graph declares, in the order of the file, with the values of the graph's own view. Two-call
 * array. Thread: beside. Errors: ARGUMENT, INCOMPLETE, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_settings(dermis_graph graph, uint32_t* count,
                                                           dermis_setting* settings);

/* Sets a declared setting from JSON text ("16", "true", "\"post\""), effective at the next record. A value that
 * changes which passes run recompiles here. For all views. Thread: beside. Errors: ARGUMENT, CONFIG, and those of
 * creation. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_set_setting(dermis_graph graph, const char* name, const char* json,
                                                              dermis_report* report);

/* ---- the choice ------------------------------------------------------------------------------------------ */

#define DERMIS_BUDGET_METER 0x1u /* times come from the calibration alone, never from timestamps: the same frames
                                    give the same choices on every machine */

/* Device time that a frame of one view may take. Settings declared with "by": "budget" are then chosen in each record: the least
 * expected error whose expected time fits. All plans that this can lead to exist from creation on; changing between
 * them allocates nothing. Times are learned with DERMIS_CONTEXT_TIMINGS; else they are those of the calibration. */
typedef struct dermis_budget {
  size_t struct_size;
  float milliseconds;               /* a frame, > 0; 0: no budget, choices take their defaults */
  uint32_t flags;                   /* DERMIS_BUDGET_... */
  const dermis_source* errors;      /* error table (docs/choice.md); NULL: as it was, at first the library's own */
  const dermis_source* calibration; /* what dermis_graph_calibration gave; NULL: as it was. What was learned is dropped */
} dermis_budget;
#define DERMIS_BUDGET_INIT {sizeof(dermis_budget), 0, 0, NULL, NULL}

/* For all views; effective at the next record; kept over reload and resize. Thread: beside. Errors: ARGUMENT, VERSION, CONFIG,
 * MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_set_budget(dermis_graph graph, const dermis_budget* budget,
                                                             dermis_report* report);

/* What a frame did not need (dermis_choice.skips). */
#define DERMIS_SKIP_NO_MATERIAL 0x1u    /* the graph has no profile: passes that scatter are not in the plan */
#define DERMIS_SKIP_NO_BOUNDS 0x2u      /* the frame's bounds are empty: no kernel ran that scatters */
#define DERMIS_SKIP_NOTHING_SEEN 0x4u   /* no pixel with subsurface: classified only, indirect dispatches of 0 groups */
#define DERMIS_SKIP_SUBPIXEL 0x8u       /* copied: tiles that scatter less than a pixel */
#define DERMIS_SKIP_FLAT_LIGHT 0x10u    /* copied: tiles as far as light reaches in which it is the same everywhere */
#define DERMIS_SKIP_HISTORY 0x20u       /* history was invalid: nothing of it was read */

/* What was chosen for a frame, and what became of it. Strings live until the next reload, resize, set_setting or
 * destroy. */
typedef struct dermis_choice {
  size_t struct_size;
  uint64_t frame_index;          /* of the frame that this is about */
  const char* outcome;           /* "technique=sap" */
  const char* technique;         /* as the error table names it; "" where none runs */
  const char* why;               /* static string */
  const char* next_better;       /* the outcome with less error that lacks least time; "" for none */
  float budget_ms;               /* 0: none */
  float predicted_ms;
  float predicted_spread_ms;     /* typical deviation of a frame */
  float measured_ms;             /* -1: not timed */
  float metered_ms;              /* by the calibration alone, for the tiles that were counted */
  float predicted_rmse;          /* of linear luminance, the light's 99.9th percentile at 1 */
  float next_better_missing_ms;  /* that the budget lacks for next_better */
  float mean_d_px;               /* widest shape parameter over the scattering tiles, geometric mean; 0: none */
  uint32_t outcome_count;
  uint32_t view_tiles;           /* 8x8 tiles of the render rectangle */
  uint32_t scattering_tiles;     /* that ran the technique */
  uint32_t copied_tiles;         /* with subsurface that scatters less than a pixel: copied */
  uint32_t switches;             /* since the graph was made */
  uint32_t reserved;             /* 0 */
  uint32_t flat_tiles;           /* with subsurface whose light is the same all around: copied */
  uint32_t skips;                /* DERMIS_SKIP_... */
  uint32_t dispatches;           /* recorded */
  uint32_t reserved_too;         /* 0 */
  uint64_t groups;               /* workgroups that these launched */
  uint32_t sampled_tiles[3];     /* that were given 8, 16 and 32 samples a pixel; of scattering_tiles */
  uint32_t sample_units;         /* of 8 samples a pixel of a tile, taken */
  uint32_t wanted_units;         /* that would have been taken without a budget */
  uint32_t reserved_three;       /* 0 */
  const char* miss;              /* static string: why times were not as predicted; "" where they were, or not known */
  uint32_t probed_tiles;         /* by subsurface.probe (configs/overlays/probe.json); 0: the error is not known */
  float probed_rmse;             /* of this very frame, linear luminance times dermis_frame.exposure */
  float probed_rmse_low;         /* to probed_rmse_high: where it lies in 95 of 100 frames */
  float probed_rmse_high;        /* infinity where one tile was probed */
  float through_rms;             /* light through thin parts, by subsurface.thin_parts: root mean square over tiles with
                                  * subsurface, linear luminance times dermis_frame.exposure; 0: none, or not counted */
  uint32_t reserved_four;        /* 0 */
} dermis_choice;
#define DERMIS_CHOICE_INIT \
  {sizeof(dermis_choice), 0, NULL, NULL, NULL, NULL, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, {0, 0, 0}, 0, 0, 0, NULL, 0, 0, 0, 0, 0, 0}

/* The newest frame whose counts came back: looks at frames up to `completed_frame_index`, as in dermis_frame. Of the
 * graph's own view. Thread: one per view. Errors: ARGUMENT, NOT_READY, DEVICE_LOST. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_choice(dermis_graph graph, uint64_t completed_frame_index,
                                                         dermis_choice* choice);
/* What is known of this device's times, as JSON for dermis_budget.calibration at the next start. *size in: room in
 * `text`; out: bytes needed with the final 0. text may be NULL. As the graph's own view
 * learned it. Thread: beside. Errors: ARGUMENT, INCOMPLETE. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_calibration(dermis_graph graph, size_t* size, char* text);

/* ---- passes of the host ---------------------------------------------------------------------------------- */

/* What a pass of the host does with what a graph binds to a port. All of it in compute shaders: the graph's barriers
 * wait for, and make visible to, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT. */
typedef enum dermis_port_usage {
  DERMIS_PORT_SAMPLED_IMAGE = 0,        /* read; SHADER_READ_ONLY_OPTIMAL or GENERAL, as dermis_pass_port.layout tells */
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
  const char* name;        /* key below "read" or "write" of a pass: a-z, 0-9, '_' */
  const char* doc;         /* for schemas and messages; may be NULL */
  dermis_port_usage usage;
  uint32_t optional;       /* 1: a graph may leave it out */
  uint32_t own_texels;     /* 1: each invocation reads only the texel or element that it alone writes, before it writes
                            * it. Required of a port that reads what another port of the pass writes; without it such
                            * graphs are refused (D0232). An update port needs it for no access of its own. */
} dermis_port;
#define DERMIS_PORT_INIT {sizeof(dermis_port), NULL, NULL, DERMIS_PORT_SAMPLED_IMAGE, 0, 0}

typedef enum dermis_kind_setting_type {
  DERMIS_KIND_SETTING_BOOL = 0,
  DERMIS_KIND_SETTING_INT = 1,
  DERMIS_KIND_SETTING_REAL = 2,
  DERMIS_KIND_SETTING_TYPE_FORCE_32BIT = 0x7fffffff
} dermis_kind_setting_type;

typedef struct dermis_kind_setting {
  size_t struct_size;
  const char* name;         /* key below "set" of a pass */
  const char* unit;         /* "px"; NULL or "": none */
  const char* doc;          /* may be NULL */
  dermis_kind_setting_type type;
  uint32_t per_frame;       /* 1: the value may differ from frame to frame and from view to view; 0: a graph has one value */
  double default_value;     /* bool: 0 or 1 */
  double minimum, maximum;  /* inclusive; of int and real */
} dermis_kind_setting;
#define DERMIS_KIND_SETTING_INIT \
  {sizeof(dermis_kind_setting), NULL, NULL, NULL, DERMIS_KIND_SETTING_BOOL, 0, 0, 0, 0}

/* What stands at a port while a pass of the host is recorded: an image, a buffer, an acceleration structure, or nothing
 * (all null). */
typedef struct dermis_pass_port {
  size_t struct_size;
  VkImage image;
  VkImageView view;      /* of the part that the graph names; storage images: of one mip */
  VkFormat format;
  VkImageLayout layout;  /* the image is in it, and must be in it when the function returns */
  uint32_t width, height; /* of the view's first mip, in texels: the allocated size, see rect_... of the call */
  VkBuffer buffer;
  uint64_t bytes;        /* of the buffer */
  uint64_t offset;       /* where they begin; not 0 in buffers that you bind alone */
  VkAccelerationStructureKHR structure;
} dermis_pass_port;
#define DERMIS_PASS_PORT_INIT \
  {sizeof(dermis_pass_port), VK_NULL_HANDLE, VK_NULL_HANDLE, VK_FORMAT_UNDEFINED, VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, \
   VK_NULL_HANDLE, 0, 0, VK_NULL_HANDLE}

/* All of it is valid until the function returns. The images and image views of a view are the same from frame to frame until
 * it is reloaded, resized or given a setting that changes its passes, but for those with history, which take turns. */
typedef struct dermis_pass_call {
  size_t struct_size;
  const char* pass;              /* name of the pass in the graph */
  VkCommandBuffer command_buffer;
  const dermis_pass_port* ports; /* as declared, in that order; stepped by ports[0].struct_size */
  const double* settings;        /* as declared, in that order */
  uint32_t port_count, setting_count;
  uint32_t rect_x, rect_y, rect_width, rect_height; /* rendered part of the view in pixels */
  uint64_t frame_index;
  void* view_user;               /* dermis_view_desc.user; NULL: the graph's own view */
} dermis_pass_call;
#define DERMIS_PASS_CALL_INIT \
  {sizeof(dermis_pass_call), NULL, NULL, NULL, NULL, 0, 0, 0, 0, 0, 0, 0, NULL}

/* Records the pass into the command buffer; called inside dermis_graph_record, by its thread. The library has put the
 * barriers before it and will put those after it, by what the ports declare: touch nothing but the ports that way, put
 * no barrier around. May bind pipelines and sets as it likes. Must not call Dermis, and must not throw. */
typedef void(DERMIS_CALL* dermis_pass_fn)(void* user, const dermis_pass_call* call);

typedef struct dermis_pass_kind {
  size_t struct_size;
  const char* name;  /* "studio.bloom": with a dot, and not beginning with "subsurface." */
  const char* doc;   /* may be NULL */
  const dermis_port* ports;
  const dermis_kind_setting* settings;
  uint32_t port_count;    /* 1..32 */
  uint32_t setting_count; /* 0..32 */
  uint32_t side_effects;  /* 1: passes of this kind run though nobody reads what they write */
  uint32_t serves_scattering; /* 1: left out where nothing scatters: without profiles, and in frames with empty bounds.
                                 0: runs there, too, unless only passes that are left out write what it has to read */
  dermis_pass_fn record;
  void* user;             /* given to `record` */
} dermis_pass_kind;
#define DERMIS_PASS_KIND_INIT {sizeof(dermis_pass_kind), NULL, NULL, NULL, NULL, 0, 0, 0, 0, NULL, NULL}

/* Makes a kind of pass known to the graphs of a context: the host's own passes then stand in the same graph, with the
 * same barriers, shared memory and history. Copied, but for `record` and `user`, which are called as long as the
 * context lives. Before the context's first graph. Thread: any, alone with this context.
 * Errors: ARGUMENT (also for a name that exists, or when there are graphs), VERSION, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_register_pass_kind(dermis_context context, const dermis_pass_kind* kind);
/* The kinds that were registered, as a JSON file for `dermis validate --kinds FILE`, so that graphs with them can be
 * checked without the host. *size in: room in `text`; out: bytes needed with the final 0. text may be NULL. Thread: any.
 * Errors: ARGUMENT, INCOMPLETE, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_export_pass_kinds(dermis_context context, size_t* size, char* text);

/* ---- each frame ------------------------------------------------------------------------------------------ */

/* The state of an image, a buffer or an acceleration structure outside of the recorded commands. With `transfer` 1 the
 * commands acquire it from `queue_family` (in `before`) or release it to that family (in `after`); the host records the
 * other half, with old and new layout both `layout`. Acceleration structures are not transferred. */
typedef struct dermis_image_state {
  VkImageLayout layout;
  uint32_t queue_family;   /* with transfer 1: the index of a family, VK_QUEUE_FAMILY_EXTERNAL, or
                              VK_QUEUE_FAMILY_FOREIGN_EXT of a device that was created with VK_EXT_queue_family_foreign;
                              else 0 or VK_QUEUE_FAMILY_IGNORED */
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 access;
  uint32_t transfer;       /* 0: no queue family ownership transfer; 1: between queue_family and the context's family */
} dermis_image_state;

/* Two slots of a frame may be bound to the same aspect and layers of an image, bytes of a buffer or acceleration structure
 * only if the graph writes neither slot (dermis_slot.written), their states are equal and transfer nothing, and, of images,
 * `before.layout` and `after.layout` are dermis_slot.best_layout. Depth and stencil of an image are different aspects. */
typedef struct dermis_image_binding {
  size_t struct_size;
  uint32_t slot;          /* dermis_slot.id */
  VkFormat format;
  VkImage image;          /* 2-D, one sample, created with dermis_slot.usage */
  VkImageView view;       /* of mip 0 and one layer; for depth formats of the depth aspect alone. With a content_id it
                             may be null: then the library makes one and keeps it while the same image comes back */
  uint32_t width, height; /* extent of mip 0 */
  dermis_image_state before, after;
  uint32_t layer;         /* first layer that is bound, 0 where layer_count is 0 */
  uint32_t layer_count;   /* layers in the states told here; others are not touched: an eye each. 0: all layers */
  uint64_t content_id;    /* your number of this image, never used for another: Vulkan gives the handle of a destroyed
                             image to a new one. 0: none, and nothing is kept from frame to frame. At most 8 images may
                             take turns in a slot within the frames in flight */
} dermis_image_binding;
#define DERMIS_IMAGE_BINDING_INIT \
  {sizeof(dermis_image_binding), 0, VK_FORMAT_UNDEFINED, VK_NULL_HANDLE, VK_NULL_HANDLE, 0, 0, \
   {VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, 0, 0}, {VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, 0, 0}, 0, 0, 0}

/* A buffer of yours at a slot of type BUFFER. Layouts of the states are VK_IMAGE_LAYOUT_UNDEFINED. */
typedef struct dermis_buffer_binding {
  size_t struct_size;
  uint32_t slot;          /* dermis_slot.id */
  uint32_t reserved;      /* 0 */
  VkBuffer buffer;        /* created with dermis_slot.usage */
  uint64_t offset;        /* a multiple of minStorageBufferOffsetAlignment */
  uint64_t bytes;         /* from there: a multiple of dermis_slot.stride, dermis_slot.bytes or more */
  dermis_image_state before, after;
} dermis_buffer_binding;
#define DERMIS_BUFFER_BINDING_INIT \
  {sizeof(dermis_buffer_binding), 0, 0, VK_NULL_HANDLE, 0, 0, \
   {VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, 0, 0}, {VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, 0, 0}}

/* A top-level acceleration structure at a slot of type ACCELERATION_STRUCTURE. `before` also stands for the builds of all
 * that lies below it. Layouts of the states are VK_IMAGE_LAYOUT_UNDEFINED, `transfer` is 0. */
typedef struct dermis_acceleration_structure_binding {
  size_t struct_size;
  uint32_t slot;          /* dermis_slot.id */
  uint32_t reserved;      /* 0 */
  VkAccelerationStructureKHR structure;
  dermis_image_state before, after;
} dermis_acceleration_structure_binding;
#define DERMIS_ACCELERATION_STRUCTURE_BINDING_INIT \
  {sizeof(dermis_acceleration_structure_binding), 0, 0, VK_NULL_HANDLE, \
   {VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, 0, 0}, {VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, 0, 0}}

typedef enum dermis_depth_kind {
  DERMIS_DEPTH_DEVICE = 0,      /* what the depth test wrote, for clip_from_view; reversed and infinite are fine */
  DERMIS_DEPTH_VIEW_UNITS = 1,  /* distance along the view axis in world units, positive; 0 = nothing there */
  DERMIS_DEPTH_KIND_FORCE_32BIT = 0x7fffffff
} dermis_depth_kind;

#define DERMIS_FRAME_RESET_HISTORY 0x1u /* camera cut, teleport, new level */
#define DERMIS_FRAME_BOUNDS 0x2u        /* nothing with subsurface lies outside of dermis_frame.bounds_... */
#define DERMIS_FRAME_LEFT_HANDED 0x4u   /* the camera looks along +z of view space; see dermis_frame */

/* One frame. Matrices act on column vectors (clip = clip_from_view * view) and are stored row by row: element
 * [r * 4 + c]. Clip space is Vulkan's: y down, depth 0..1.
 * View space is x right, y up. In a right-handed view space the camera looks down -z, in a left-handed one (Unreal,
 * DirectXMath ...LH) along +z. A perspective projection states this by its last row: w = -z or w = z; the flag is not
 * needed. An orthographic projection cannot: set DERMIS_FRAME_LEFT_HANDED where its view space is left-handed. All
 * matrices of a frame and images of normals are of the same view space. Matrices that contradict the flag, each other or
 * the depth range (all of it behind the camera) are DERMIS_ERROR_ARGUMENT.
 * clip_from_view is what the picture was rendered with; jitter_x and jitter_y tell how many pixels of shift are in it.
 * The previous matrices are what the frame before had here; where they are no projection (all 0), histories that follow
 * surfaces begin anew in each frame. */
typedef struct dermis_frame {
  size_t struct_size;
  VkCommandBuffer command_buffer;  /* recording, outside a render pass, of the context's queue family */
  const dermis_image_binding* bindings;
  uint32_t binding_count;
  uint32_t flags;                  /* DERMIS_FRAME_... */
  uint64_t frame_index;            /* from 1, grows by at least 1 from frame to frame */
  uint64_t completed_frame_index;  /* newest frame whose commands the device has finished; less than frame_index;
                                      frame_index - completed_frame_index <= frames_in_flight. 0 before the first */
  uint32_t rect_x, rect_y, rect_width, rect_height; /* rendered part in pixels; width 0: the allocated size */
  float clip_from_view[16];
  float view_from_world[16];
  float previous_clip_from_view[16];
  float previous_view_from_world[16];
  float jitter_x, jitter_y;        /* pixels, +x right, +y down: shift of the picture, in clip_from_view */
  float metres_per_unit;           /* 0 = 1 */
  float exposure;                  /* linear factor the host applies later; 0 = 1 */
  float delta_seconds;
  dermis_depth_kind depth_kind;
  /* With DERMIS_FRAME_BOUNDS: where subsurface may be seen, pixels of the images; what lies outside of the rendered part
     does not count. Empty: no kernel runs but those that hand out pictures beside lighting. */
  uint32_t bounds_x, bounds_y, bounds_width, bounds_height;
  const dermis_buffer_binding* buffers; /* stepped by buffers[0].struct_size */
  const dermis_acceleration_structure_binding* structures;
  uint32_t buffer_count, structure_count;
} dermis_frame;
#define DERMIS_FRAME_INIT \
  {sizeof(dermis_frame), NULL, NULL, 0, 0, 0, 0, 0, 0, 0, 0, {0}, {0}, {0}, {0}, 0, 0, 0, 0, 0, DERMIS_DEPTH_DEVICE, 0, 0, 0, 0, \
   NULL, NULL, 0, 0}

/* Records the plan for the graph's own view. Never submits, waits for the device, prints or allocates host memory. On an
 * error nothing was recorded. Thread: one per view. Errors: ARGUMENT, VERSION, VULKAN, DEVICE_LOST, DEVICE_MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_record(dermis_graph graph, const dermis_frame* frame);
/* The frame recorded last will never be submitted: the graph is as it was before that record, histories included, and
 * frame_index may be used again. At most one frame, and before the next dermis_graph_record, dermis_graph_reload or
 * dermis_graph_resize. Its command buffer must not run. Thread: one per view. Errors: ARGUMENT. */
DERMIS_API dermis_result DERMIS_CALL dermis_frame_discard(dermis_graph graph, uint64_t frame_index);

/* ---- a frame as data ------------------------------------------------------------------------------------- */

/* For a host that records all commands itself. What each command does is what the Vulkan function of its name does with
 * these arguments. */
typedef enum dermis_command_type {
  DERMIS_COMMAND_BARRIER = 0,           /* vkCmdPipelineBarrier2: dependency */
  DERMIS_COMMAND_DISPATCH = 1,          /* bind pipeline, bind `sets` from set 0 on, push constants, dispatch: groups */
  DERMIS_COMMAND_DISPATCH_INDIRECT = 2, /* the same, with the groups from buffer and offset */
  DERMIS_COMMAND_FILL_BUFFER = 3,       /* buffer, offset, bytes, value */
  DERMIS_COMMAND_CLEAR_IMAGE = 4,       /* vkCmdClearColorImage: image, image_layout, color, ranges */
  DERMIS_COMMAND_COPY_BUFFER = 5,       /* buffer, to_buffer, buffer_copies */
  DERMIS_COMMAND_COPY_IMAGE = 6,        /* image, image_layout, to_image, to_layout, image_copies */
  DERMIS_COMMAND_RESET_QUERIES = 7,     /* query_pool, query, count */
  DERMIS_COMMAND_WRITE_TIMESTAMP = 8,   /* vkCmdWriteTimestamp2: stages, query_pool, query */
  DERMIS_COMMAND_HOST_PASS = 9,         /* your own pass: call, whose command_buffer is NULL; its function is not called */
  DERMIS_COMMAND_TYPE_FORCE_32BIT = 0x7fffffff
} dermis_command_type;

/* Fields that the type does not name are zero. All are compute or transfer commands. */
typedef struct dermis_command {
  size_t struct_size;
  dermis_command_type type;
  uint32_t count;                     /* of ranges, regions or queries */
  const char* pass;                   /* that it belongs to; "" around all passes */
  const VkDependencyInfo* dependency;
  VkPipeline pipeline;                /* VK_PIPELINE_BIND_POINT_COMPUTE */
  VkPipelineLayout layout;
  const VkDescriptorSet* sets;
  const void* push_constants;         /* VK_SHADER_STAGE_COMPUTE_BIT, from offset 0 */
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
  {sizeof(dermis_command), DERMIS_COMMAND_BARRIER, 0, NULL, NULL, VK_NULL_HANDLE, VK_NULL_HANDLE, NULL, NULL, 0, 0, \
   {0, 0, 0}, 0, VK_NULL_HANDLE, VK_NULL_HANDLE, 0, 0, VK_NULL_HANDLE, VK_NULL_HANDLE, VK_IMAGE_LAYOUT_UNDEFINED, \
   VK_IMAGE_LAYOUT_UNDEFINED, {{0, 0, 0, 0}}, NULL, NULL, NULL, 0, VK_NULL_HANDLE, 0, NULL}

/* As dermis_graph_record, but the commands are returned and frame.command_buffer is not looked at. They stand for a
 * recorded frame in every respect: record all of them once, in their order, outside of a render pass, on a queue of the
 * context's family, or take the frame back with dermis_frame_discard. *commands is stepped by its first struct_size and
 * lives until the next call that records this view, or its end. Allocates host memory until the list is as long as it
 * gets. Thread: one per view. Errors: as dermis_graph_record, and MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_graph_commands(dermis_graph graph, const dermis_frame* frame,
                                                           uint32_t* count, const dermis_command** commands);

/* ---- more views ------------------------------------------------------------------------------------------ */

/* A camera of a graph, beside the graph's own: an eye, a player of a split screen, a mirror. Views share the plan, the
 * pipelines, settings and budget; histories, transient memory, frame numbers and what is learned of times are each one's
 * own, and so are settings that dermis_view_set_setting sets. All have the graph's allocated size and slots; each frame
 * renders its own rectangle into its own images. */
typedef struct dermis_view_desc {
  size_t struct_size;
  void* user; /* dermis_pass_call.view_user */
} dermis_view_desc;
#define DERMIS_VIEW_DESC_INIT {sizeof(dermis_view_desc), NULL}

/* Compiles nothing; allocates what a view needs. desc may be NULL. *view is NULL on failure. *report (may be NULL) gets
 * the messages. Thread: beside. Errors: ARGUMENT, VERSION, MEMORY, DEVICE_MEMORY, VULKAN, DEVICE_LOST. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_create(dermis_graph graph, const dermis_view_desc* desc,
                                                        dermis_view* view, dermis_report* report);
/* The device must have finished every frame recorded with it. NULL is ignored. Not after dermis_graph_destroy, which
 * destroys it. Thread: beside, alone with this view. Errors: none. */
DERMIS_API void DERMIS_CALL dermis_view_destroy(dermis_view view);
/* As dermis_graph_record, for this view: frame_index grows from frame to frame of the view, and completed_frame_index is
 * the newest of them that the device has finished. Thread: one per view. Errors: as dermis_graph_record. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_record(dermis_view view, const dermis_frame* frame);
/* As dermis_graph_commands, for this view. Thread: one per view. Errors: as dermis_graph_commands. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_commands(dermis_view view, const dermis_frame* frame, uint32_t* count,
                                                          const dermis_command** commands);
/* As dermis_frame_discard, for this view. Thread: one per view. Errors: ARGUMENT. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_discard(dermis_view view, uint64_t frame_index);
/* As dermis_graph_choice, for this view. Thread: one per view. Errors: ARGUMENT, NOT_READY, DEVICE_LOST. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_choice(dermis_view view, uint64_t completed_frame_index,
                                                        dermis_choice* choice);
/* As dermis_graph_timings, for this view. Thread: one per view. Errors: ARGUMENT, INCOMPLETE, NOT_READY, DEVICE_LOST. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_timings(dermis_view view, uint64_t completed_frame_index,
                                                         uint32_t* count, dermis_pass_timing* timings);
/* As dermis_graph_histories, for this view. Thread: one per view. Errors: ARGUMENT, INCOMPLETE. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_histories(dermis_view view, uint32_t* count, dermis_history* histories);

/* As dermis_graph_settings, with the values of this view. Thread: beside. Errors: ARGUMENT, INCOMPLETE, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_settings(dermis_view view, uint32_t* count, dermis_setting* settings);
/* Gives this view its own value of a setting that is listed as per_frame, from its next record on, whatever the
 * graph's value is; json NULL: the graph's value again. A setting of the graph is refused. Kept over reload and
 * resize, as settings of the graph are. Thread: beside. Errors: ARGUMENT, CONFIG, MEMORY. */
DERMIS_API dermis_result DERMIS_CALL dermis_view_set_setting(dermis_view view, const char* name, const char* json,
                                                             dermis_report* report);

#ifdef __cplusplus
}
#endif
#endif /* DERMIS_DERMIS_H */

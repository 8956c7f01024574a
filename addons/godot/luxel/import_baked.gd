@tool
# Import script for baked.glb: its surfaces show the light of lightmap.exr, which lies beside it.
#
# In the import dock: Import Script > Path = this file, then Reimport. docs/guide/godot.md has the rest.
# A baked material names its lightmap in extras.luxel.lightmap; Godot 4.4 and later keep the extras.
extends EditorScenePostImport

# What a diffuse surface sends to the eye: rho E / pi + emission. `unshaded` shows ALBEDO as it is, so no
# light of the scene counts twice. TEXCOORD_1 of glTF is UV2.
const SHADER := """
shader_type spatial;
render_mode unshaded, %s;

uniform sampler2D lightmap : filter_linear, repeat_disable;
uniform vec4 base_color : source_color = vec4(1.0);
uniform sampler2D base_texture : source_color, hint_default_white;
uniform bool vertex_colors = false;
uniform float metallic = 0.0;
uniform sampler2D metallic_texture : hint_default_white;
uniform vec4 emission : source_color = vec4(0.0);
uniform sampler2D emission_texture : source_color, hint_default_black;
uniform bool emission_multiplies = false;
uniform float emission_energy = 1.0;
uniform vec2 uv_scale = vec2(1.0);
uniform vec2 uv_offset = vec2(0.0);
uniform float alpha_cutoff = 0.5;

void fragment() {
	vec2 uv = UV * uv_scale + uv_offset;
	vec4 base = base_color * texture(base_texture, uv);
	if (vertex_colors) {
		base.rgb *= COLOR.rgb;
	}
	vec3 reflectance = min(base.rgb * (1.0 - metallic * texture(metallic_texture, uv).b), vec3(0.99));
	vec3 glow = texture(emission_texture, uv).rgb;
	glow = emission_energy * (emission_multiplies ? emission.rgb * glow : emission.rgb + glow);
	ALBEDO = reflectance * texture(lightmap, UV2).rgb / PI + glow;
	%s
}
"""

var _shaders := {}    # by their text
var _lightmaps := {}  # by the names of their files
var _baked := {}      # by the materials that they stand for


func _post_import(scene: Node) -> Object:
	_light(scene)
	if _baked.is_empty():
		push_warning("%s: no material names a lightmap; was it baked by luxel?" % get_source_file())
	return scene


func _light(node: Node) -> void:
	if node is MeshInstance3D and _luxel_extras(node).get("bake", true):
		for surface in node.mesh.get_surface_count():
			var baked := _baked_material(node.mesh.surface_get_material(surface))
			if baked:
				node.mesh.surface_set_material(surface, baked)
	for child in node.get_children():
		_light(child)


func _luxel_extras(thing: Object) -> Dictionary:
	return thing.get_meta("extras", {}).get("luxel", {})


# Null: the material stays as it is. It is unlit, or no baked one.
func _baked_material(loaded: Material) -> ShaderMaterial:
	if not loaded is BaseMaterial3D or loaded.shading_mode == BaseMaterial3D.SHADING_MODE_UNSHADED:
		return null
	var file: String = _luxel_extras(loaded).get("lightmap", "")
	if file.is_empty():
		return null
	if not _baked.has(loaded):
		var lightmap := _lightmap(file)
		if lightmap == null:
			return null
		_baked[loaded] = _with_lightmap(loaded, lightmap)
	return _baked[loaded]


# Read as it is, in 16 bits, and kept in the imported scene: no setting of a texture importer can spoil it.
func _lightmap(file: String) -> ImageTexture:
	if not _lightmaps.has(file):
		var path := get_source_file().get_base_dir().path_join(file)
		var image := Image.load_from_file(ProjectSettings.globalize_path(path))
		if image == null or image.is_empty():
			push_error("%s is missing or not an EXR file; copy it from the folder of the bake" % path)
			_lightmaps[file] = null
		else:
			_lightmaps[file] = ImageTexture.create_from_image(image)
	return _lightmaps[file]


func _with_lightmap(loaded: BaseMaterial3D, lightmap: ImageTexture) -> ShaderMaterial:
	var made := ShaderMaterial.new()
	made.resource_name = loaded.resource_name
	made.shader = _shader(loaded)
	made.set_shader_parameter("lightmap", lightmap)
	made.set_shader_parameter("base_color", loaded.albedo_color)
	made.set_shader_parameter("base_texture", loaded.albedo_texture)
	made.set_shader_parameter("vertex_colors", loaded.vertex_color_use_as_albedo)
	made.set_shader_parameter("metallic", loaded.metallic)
	made.set_shader_parameter("metallic_texture", loaded.metallic_texture)
	if loaded.emission_enabled:
		made.set_shader_parameter("emission", loaded.emission)
		made.set_shader_parameter("emission_texture", loaded.emission_texture)
		made.set_shader_parameter("emission_energy", loaded.emission_energy_multiplier)
		made.set_shader_parameter("emission_multiplies",
				loaded.emission_operator == BaseMaterial3D.EMISSION_OP_MULTIPLY)
	made.set_shader_parameter("uv_scale", Vector2(loaded.uv1_scale.x, loaded.uv1_scale.y))
	made.set_shader_parameter("uv_offset", Vector2(loaded.uv1_offset.x, loaded.uv1_offset.y))
	made.set_shader_parameter("alpha_cutoff", loaded.alpha_scissor_threshold)
	return made


# A shader that writes ALPHA is sorted and blended, so opaque materials get one that does not.
func _shader(loaded: BaseMaterial3D) -> Shader:
	var cull := "cull_disabled" if loaded.cull_mode == BaseMaterial3D.CULL_DISABLED else "cull_back"
	var alpha := "ALPHA = base.a;"
	if loaded.transparency == BaseMaterial3D.TRANSPARENCY_DISABLED:
		alpha = ""
	elif loaded.transparency == BaseMaterial3D.TRANSPARENCY_ALPHA_SCISSOR:
		alpha = "ALPHA = base.a;\n\tALPHA_SCISSOR_THRESHOLD = alpha_cutoff;"
	var text := SHADER % [cull, alpha]
	if not _shaders.has(text):
		var shader := Shader.new()
		shader.code = text
		_shaders[text] = shader
	return _shaders[text]

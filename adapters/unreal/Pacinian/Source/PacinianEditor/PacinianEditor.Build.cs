using UnrealBuildTool;

/// The editor's part: how it shows the components, and the server that it starts.
public class PacinianEditor : ModuleRules
{
    public PacinianEditor(ReadOnlyTargetRules Target) : base(Target)
    {
        PCHUsage = PCHUsageMode.UseExplicitOrSharedPCHs;
        bUseUnity = false;
        bEnableExceptions = false;
        bUseRTTI = false;
        PrivateDependencyModuleNames.AddRange(new string[] { "Core", "CoreUObject", "Engine", "Pacinian" });
        PrivateDependencyModuleNames.AddRange(new string[] { "PropertyEditor", "Slate", "SlateCore", "ToolMenus", "UnrealEd" });
    }
}

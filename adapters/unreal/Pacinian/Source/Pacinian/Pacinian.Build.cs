using UnrealBuildTool;

/// The components.
public class Pacinian : ModuleRules
{
    public Pacinian(ReadOnlyTargetRules Target) : base(Target)
    {
        PCHUsage = PCHUsageMode.UseExplicitOrSharedPCHs;
        bUseUnity = false; // files have names of their own in anonymous namespaces
        bEnableExceptions = false;
        bUseRTTI = false;
        PublicDependencyModuleNames.AddRange(new string[] { "Core", "CoreUObject", "Engine", "DeveloperSettings" });
        PrivateDependencyModuleNames.AddRange(new string[] { "HeadMountedDisplay", "InputCore", "PacinianCore", "PhysicsCore", "RenderCore", "RHI" });
    }
}

using System.IO;
using UnrealBuildTool;

/// The wire and the client, without the engine: C++17, neither exceptions nor RTTI. Tested outside of it by adapters/cpp.
/// It uses libzmq, which servers on other machines need, where the headers of the module ZeroMQ are in place.
public class PacinianCore : ModuleRules
{
    public PacinianCore(ReadOnlyTargetRules Target) : base(Target)
    {
        PCHUsage = PCHUsageMode.NoPCHs;
        bUseUnity = false; // files have names of their own in anonymous namespaces, and some include windows.h
        bEnableExceptions = false;
        bUseRTTI = false;
        PrivateIncludePaths.Add(Path.Combine(ModuleDirectory, "Private"));
        PrivateDependencyModuleNames.AddRange(new string[] { "Core", "Projects" });
        string Header = Path.Combine(ModuleDirectory, "..", "ThirdParty", "ZeroMQ", "Include", "zmq.h");
        ExternalDependencies.Add(Header); // the module is built again when it comes or goes
        if (File.Exists(Header))
        {
            PrivateDependencyModuleNames.AddRange(new string[] { "ZeroMQ" });
            PrivateDefinitions.Add("PACINIAN_LIBZMQ=1");
        }
        if (Target.Platform == UnrealTargetPlatform.Win64)
        {
            PublicSystemLibraries.Add("ws2_32.lib");
        }
    }
}
